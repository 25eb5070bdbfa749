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
            return tyro.cli(
                what,
                prog="bikesim",
                args=list(arguments),
                description=description,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
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
        text = re.sub(r"\x1b\[[0-9;]*m", "", line).strip("│╭╮╰╯ ")
        if re.match(r"(For full helptext|Argument helptext)", text):
            break
        if not re.fullmatch(r"[─-]*", text):
            parts.append(text)
    message = " ".join(" ".join(parts or box.split()).split())
    message, _, near = message.partition(" Perhaps you meant:")
    message = _UNION.sub(r"must be a number, not \1", message)
    options = re.findall(r"--[a-z-]+", near)
    return f"{message}; did you mean {' or '.join(dict.fromkeys(options))}?" if options else message


# What tyro says of an optional number that is none, in its own terms.
_UNION = re.compile(r"no type matching \{None\}\|\w+ could be instantiated from \['(.*?)'\]\. .*")
