"""bikesim bench: the commands of a real bench, one file each."""

from dataclasses import dataclass

from bikesim.cli.bench.calibrate import Calibrate
from bikesim.cli.bench.check import Check
from bikesim.cli.bench.display import Display
from bikesim.cli.bench.emulate import Emulate
from bikesim.cli.bench.identify import Identify
from bikesim.cli.bench.margins import Margins
from bikesim.cli.bench.run import Run
from bikesim.cli.parsing import parse

_DESCRIPTION = (
    "A real bench on a CAN bus, in the order in which a person would: check who answers, calibrate "
    "the sensors, identify the bar, look at its margins, ride, or emulate a bench to try it "
    "without. bikesim bench COMMAND --help says more."
)

# A further command: a file beside this one, and a line here.
COMMANDS = {
    "check": Check,
    "calibrate": Calibrate,
    "identify": Identify,
    "margins": Margins,
    "run": Run,
    "display": Display,
    "emulate": Emulate,
}


@dataclass(frozen=True)
class Bench:
    """A real bench on a CAN bus: check, calibrate, identify, margins, run, display, emulate."""


def parse_bench(arguments: list[str]):
    """The command that the arguments after `bench` ask for; None if they ask for help."""
    return parse(COMMANDS, arguments, _DESCRIPTION, prog="bikesim bench")
