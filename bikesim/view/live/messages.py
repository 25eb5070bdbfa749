"""What the live display says: in its corners while one rides, in the middle when one does not."""

import math
from textwrap import wrap
from typing import NamedTuple

from bikesim.bench.onlooker import Phase, Sight
from bikesim.bench.showing import Showing
from bikesim.model.haptic import BicycleState
from bikesim.view.drawing import GREEN, GREY, ORANGE, VERMILION
from bikesim.view.live.words import Line

_LONGEST = 46  # letters of a line
_OFTEN = 0.1  # s between two figures: faster ones cannot be read


class Message(NamedTuple):
    """What is said, and something smaller under it."""

    text: str
    more: str = ""

    @property
    def lines(self) -> tuple[Line, ...]:
        """To be written."""
        first = [Line(text, 34, bold=True) for text in wrap(self.text, _LONGEST)]
        return (*first, *(Line(text, 22, GREY) for text in wrap(self.more, _LONGEST)))


def message(sight: Sight) -> Message | None:
    """What is to be said of a ride that is not being ridden; None while it is."""
    match sight.phase:
        case Phase.READY:
            return Message(sight.words or "the bench is being set up")
        case Phase.SILENT:
            why = "it hangs" if sight.alive else "its process has ended"
            return Message(f"no picture from the ride for {sight.silence:.0f} s", why)
        case Phase.OVER:
            return Message(sight.words or "the ride is over", "waiting for the next ride")
    return None


class Corners(NamedTuple):
    """What stands in the upper left, and in the upper right."""

    left: tuple[Line, ...]
    right: tuple[Line, ...]


class Figures:
    """Of a ride: speed, steer and time, and its haptics. Nothing that tells of the roll."""

    def __init__(self, showing: Showing) -> None:
        self._showing = showing
        self._written: tuple[float, Corners] | None = None

    def at(self, state: BicycleState) -> Corners:
        """The figures, new ones ten times a second."""
        time = float(state.time)
        if self._written is None or not 0 <= time - self._written[0] < _OFTEN:
            self._written = time, Corners(_figures(state), self._haptics(time))
        return self._written[1]

    def _haptics(self, time: float) -> tuple[Line, ...]:
        if time < self._showing.ramp_in:
            return (Line("the torque ramps in", 22, ORANGE, bold=True),)
        words = self._showing.haptics
        return (Line(words, 22, VERMILION if words == "haptics off" else GREEN, bold=True),)


def _figures(state: BicycleState) -> tuple[Line, ...]:
    steer = math.degrees(float(state.steer))
    side = "" if abs(steer) < 0.05 else " right" if steer > 0 else " left"
    return (
        Line(f"{float(state.speed):.1f} m/s", 30, bold=True),
        Line(f"steer {abs(steer):.1f}°{side}"),
        Line(f"{float(state.time):.1f} s", 22, GREY),
    )
