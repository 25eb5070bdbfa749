"""tyro, with its errors in one line."""

import contextlib
import dataclasses
import difflib
import io
import re
import sys
from collections.abc import Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Annotated, Any

import tyro

from bikesim.errors import InputError, unknown

# An on/off option, whose default needs no word.
Flag = Annotated[bool, tyro.conf.arg(help_behavior_hint="")]


def parse(
    commands: Mapping[str, type],
    arguments: Sequence[str],
    description: str,
    prog: str = "bikesim",
) -> Any:
    """The command that the arguments ask for, None if they ask for help. Raises InputError."""
    name, rest = (arguments[0], arguments[1:]) if arguments else ("--help", ())
    if name in commands:
        return _parsed(commands[name], f"{prog} {name}", rest)
    if not name.startswith("-"):
        raise unknown(f"{prog} command".removeprefix("bikesim "), name, commands)
    return _parsed(_all_of(commands), prog, arguments or ["--help"], description)


def _all_of(commands: Mapping[str, type]) -> Any:
    """All commands as one type for tyro, each with the first line of what it says of itself."""
    return reduce(
        or_,
        (
            Annotated[
                command,
                tyro.conf.subcommand(name, description=(command.__doc__ or "").partition("\n")[0]),
            ]
            for name, command in commands.items()
        ),
    )


def _parsed(what: Any, prog: str, arguments: Sequence[str], description: str | None = None) -> Any:
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return tyro.cli(
                what,
                prog=prog,
                args=list(arguments),
                description=description,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
    except SystemExit as ending:
        if ending.code in (0, None):
            return None
        message = one_line(said.getvalue(), arguments, _options(what))
        raise InputError(f"{message} ({prog} --help)") from None
    finally:
        if sys.exc_info()[0] is None:
            sys.stderr.write(said.getvalue())


def _options(command: Any) -> list[str]:
    fields = dataclasses.fields(command) if dataclasses.is_dataclass(command) else ()
    return [f"--{field.name.replace('_', '-')}" for field in fields]


def one_line(box: str, arguments: Sequence[str], known: Sequence[str]) -> str:
    """What tyro says in a box of many lines, in a few words of our own."""
    text = " ".join(re.sub(r"\x1b\[[0-9;]*m|[│╭╮╰╯─]", " ", box).split())
    if found := re.search(r"Missing value for argument '(\S+?)'", text):
        return f"{found[1].split('/')[-1]}: a value is missing"
    if found := re.search(r"Missing from [\w ]+: (\S+)", text):
        return f"{found[1]} is missing"
    if found := re.search(r"Error parsing (\S+): (.*)", text):
        return f"{_with_value(found[1], arguments)}: must be {_kind(found[2])}"
    if found := re.search(r"Unrecognized options: (\S+)", text):
        return _unrecognized(found[1].rstrip(",").partition("=")[0], known)
    return text


def _with_value(option: str, arguments: Sequence[str]) -> str:
    """The option as the user wrote it; tyro's own box breaks a value where its line ends."""
    name = option.rsplit("/", maxsplit=1)[-1]
    for i, argument in enumerate(arguments):
        if argument.partition("=")[0] == name:
            return argument if "=" in argument else " ".join(arguments[i : i + 2])
    return name


def _kind(said: str) -> str:
    return "a whole number" if re.search(r"<class 'int'>|\|INT\b", said) else "a number"


def _unrecognized(name: str, known: Sequence[str]) -> str:
    if not name.startswith("-"):
        return f"unexpected argument {name}"
    near = difflib.get_close_matches(name, known, n=2, cutoff=0.6)
    return f"unknown option {name}" + (f"; did you mean {' or '.join(near)}?" if near else "")
