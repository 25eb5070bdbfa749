"""A host as a process of its own that does one command after the other, as somebody tells it.

Started as a script: reads a JSON object a line, gives its command to the command line that users
have, and answers with a line of JSON. What it imports is then imported once for many rides.
"""

import json
import math
import os
import sys
import traceback
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, redirect_stderr, redirect_stdout
from io import StringIO
from typing import Any
from unittest.mock import patch

import can

from bikesim.cli.main import main
from bikesim.model.haptic import BicycleState, HapticBicycle


class Buses:
    """Knows the bus that was opened last: the one that is ridden on."""

    newest: can.BusABC

    @staticmethod
    def watch() -> None:
        open_it = can.ThreadSafeBus.__init__

        def opened(self: can.ThreadSafeBus, *arguments: Any, **more: Any) -> None:
            open_it(self, *arguments, **more)
            Buses.newest = self

        can.ThreadSafeBus.__init__ = opened


def nan(state: BicycleState) -> BicycleState:
    """A model that has gone wrong (row 10)."""
    return state._replace(feedback_torque=math.nan)


def lose_the_bus(state: BicycleState) -> BicycleState:
    """What was the interface is no longer one (row 20): the system refuses to send and receive."""
    elsewhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(elsewhere, Buses.newest.fileno())
    os.close(elsewhere)
    return state


TRICKS = {"nan": nan, "lose the bus": lose_the_bus}


def tricked(
    trick: Callable[[BicycleState], BicycleState] | None, time: float
) -> AbstractContextManager[object]:
    """From a time of the ride on [s], with what becomes of each of the model's states."""
    if trick is None:
        return nullcontext()
    step = HapticBicycle.step

    def stepped(self: HapticBicycle, before: BicycleState, now: float, *measured: float):
        state = step(self, before, now, *measured)
        return trick(state) if now >= time else state

    return patch.object(HapticBicycle, "step", stepped)


def answer(order: dict) -> dict:
    """Exit status and what was printed; a traceback is for the test to find."""
    out, err = StringIO(), StringIO()
    trick = TRICKS.get(order["trick"])
    with redirect_stdout(out), redirect_stderr(err), tricked(trick, order["time"]):
        try:
            status = main(order["arguments"])
        except BaseException:
            status = 1
            traceback.print_exc()
    return {"status": status, "out": out.getvalue(), "err": err.getvalue()}


if __name__ == "__main__":
    Buses.watch()
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), flush=True)
