"""The command line: parses, calls, prints. One file a command, imported with light hands.

Exit status 0 when done (a fall is a result), 2 for bad input with one line on stderr, 130 when
interrupted where nothing could be finished.
"""

import os
import sys
from collections.abc import Sequence
from typing import Annotated, Protocol

import tyro

from bikesim import __version__
from bikesim.cli.eig import Eig
from bikesim.cli.export import Export
from bikesim.cli.info import Info
from bikesim.cli.paper import Paper
from bikesim.cli.parsing import parse
from bikesim.cli.plot import Plot
from bikesim.cli.replay import Replay
from bikesim.cli.run import Run
from bikesim.errors import InputError

_DESCRIPTION = (
    "A haptic bicycle simulator (Schwab & Recuero 2013): ride a bicycle in the virtual rig, "
    "look at its dynamics, and check both against the paper."
)

_command = tyro.conf.subcommand
Command = (
    Annotated[Run, _command("run")]
    | Annotated[Eig, _command("eig")]
    | Annotated[Paper, _command("paper")]
    | Annotated[Replay, _command("replay")]
    | Annotated[Plot, _command("plot")]
    | Annotated[Info, _command("info")]
    | Annotated[Export, _command("export")]
)


class _Runnable(Protocol):
    def __call__(self) -> int: ...


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; gives the exit status."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    if arguments == ["--version"]:
        print(f"bikesim {__version__}")
        return 0
    try:
        command: _Runnable = parse(Command, arguments or ["--help"], _DESCRIPTION)
        return command()
    except InputError as error:
        print(f"bikesim: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("bikesim: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader of a pipe has gone; writing the rest would only say so again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
