"""tyro, with its errors in one line."""

import contextlib
import io
import re
import sys
from collections.abc import Sequence
from typing import Any

import tyro

from bikesim.errors import InputError


def parse(what: Any, arguments: Sequence[str], description: str) -> Any:
    """The command that the arguments ask for. Raises InputError; exits after printing help."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return tyro.cli(what, prog="bikesim", args=list(arguments), description=description)
    except SystemExit as ending:
        if ending.code in (0, None):
            raise
        raise InputError(one_line(said.getvalue())) from None
    finally:
        if sys.exc_info()[0] is None:
            sys.stderr.write(said.getvalue())


def one_line(box: str) -> str:
    """The message inside a box that tyro drew, without its help."""
    parts: list[str] = []
    for line in box.splitlines()[1:]:
        text = line.strip("│╭╮╰╯ ").strip()
        if re.match(r"(For full helptext|Argument helptext)", text):
            break
        if not re.fullmatch(r"[─-]*", text):
            parts.append(text)
    message = re.sub(r"\s+", " ", " ".join(parts))
    message = re.sub(r"\x1b\[[0-9;]*m", "", message)
    return (message or " ".join(box.split())).replace(" Perhaps you meant:", "; perhaps you meant")
