"""The command line: parses, calls, prints. One file a command, imported with light hands.

Exit status 0 when done (a fall is a result), 2 for bad input with one line on stderr, 130 when
interrupted where nothing could be finished.
"""

import os
import sys
from collections.abc import Sequence
from typing import Protocol

from bikesim import __version__
from bikesim.cli.bench.commands import Bench, parse_bench
from bikesim.cli.eig import Eig
from bikesim.cli.experiment import Experiment
from bikesim.cli.export import Export
from bikesim.cli.identify import Identify
from bikesim.cli.info import Info
from bikesim.cli.margins import Margins
from bikesim.cli.paper import Paper
from bikesim.cli.parsing import parse
from bikesim.cli.plot import Plot
from bikesim.cli.render import Render
from bikesim.cli.replay import Replay
from bikesim.cli.rider import Rider
from bikesim.cli.run import Run
from bikesim.cli.surroundings import ended_by_signals, prepare_streams
from bikesim.errors import InputError

_DESCRIPTION = (
    "A haptic bicycle simulator (Schwab & Recuero 2013): ride a bicycle in the virtual rig, "
    "look at its dynamics, and check both against the paper. bikesim COMMAND --help says more."
)

_COMMANDS = {
    "run": Run,
    "experiment": Experiment,
    "identify": Identify,
    "rider": Rider,
    "bench": Bench,
    "eig": Eig,
    "margins": Margins,
    "paper": Paper,
    "render": Render,
    "replay": Replay,
    "plot": Plot,
    "info": Info,
    "export": Export,
}


class _Runnable(Protocol):
    def __call__(self) -> int: ...


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; gives the exit status."""
    prepare_streams()
    try:
        with ended_by_signals():
            return _answered(arguments)
    except KeyboardInterrupt:
        print("bikesim: interrupted", file=sys.stderr)
        return 130


def _answered(arguments: Sequence[str] | None) -> int:
    try:
        status = _called(list(sys.argv[1:] if arguments is None else arguments))
        sys.stdout.flush()
        return status
    except InputError as error:
        return _refused(str(error))
    except BrokenPipeError:
        # The reader of a pipe has gone; writing the rest would only say so again.
        _drop_output()
        return 0
    except OSError as error:
        _drop_output()
        where = "" if error.filename is None else f"{error.filename}: "
        return _refused(f"{where}{(error.strerror or str(error)).lower()}")


def _called(arguments: list[str]) -> int:
    if arguments == ["--version"]:
        print(f"bikesim {__version__}")
        return 0
    command: _Runnable | None = (
        parse_bench(arguments[1:])
        if arguments[:1] == ["bench"]
        else parse(_COMMANDS, arguments, _DESCRIPTION)
    )
    return 0 if command is None else command()


def _refused(message: str) -> int:
    print(f"bikesim: {' '.join(message.split())}", file=sys.stderr)
    return 2


def _drop_output() -> None:
    """What cannot be written goes nowhere, now and at the end of the program."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
