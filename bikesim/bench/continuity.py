"""Whether frames of a sensor node come one after the other: counter and sample time."""

import math
from enum import Enum
from typing import NamedTuple

COUNTS = 15  # the counter goes 0 to 14
TIME_UNIT = 1e-5  # s
_WRAP = 65536
_SHORT = 0.3  # s, less than half a wrap-around
_DRIFT = 1e-3
_ALIKE = 0.75  # frames; a wrap moves the counter by 4.6 of 15 (node) or 5.5 (wheel)


class Flaw(Enum):
    """Why a frame is not to be used."""

    LENGTH = "not 8 bytes long"
    CRC = "CRC wrong"
    REPEATED = "counter unchanged"
    FROZEN = "sample time unchanged or gone back"


class BadFrame(NamedTuple):
    """A frame that is not to be used."""

    flaw: Flaw


class Passage(NamedTuple):
    """A good frame's place: sample time [s] on the node's clock, frames lost just before it."""

    time: float
    lost: int


class Continuity:
    """Follows counter and sample time of frames that are sent every `period` [s].

    The time of the first frame is its own, within a wrap-around (0.65536 s).
    """

    def __init__(self, period: float) -> None:
        self._step = period / TIME_UNIT
        self._counter = -1
        self._ticks = 0  # unwrapped, in TIME_UNIT
        self._arrival = -math.inf
        self._ahead = math.inf
        """Of the host's clock [s]; frames that waited in a buffer make it no larger."""

    def follow(self, counter: int, ticks: int, arrival: float) -> Passage | Flaw:
        """For a frame's counter, its sample time [10 us] and when it came [s], host's clock."""
        steps = (counter - self._counter) % COUNTS
        passed = (ticks - self._ticks) % _WRAP
        # The usual case, without what only a long gap needs: this is done in each tick.
        off = passed - steps * self._step
        if not (steps and abs(off) < 0.5 * self._step and arrival - self._arrival < _SHORT):
            if self._counter < 0:
                self._keep(counter, ticks, arrival)
                return Passage(ticks * TIME_UNIT, 0)
            passed = self._unwrapped(steps, passed, arrival)
            # The time tells how often the counter went around.
            laps = round((passed / self._step - steps) / COUNTS)
            steps += COUNTS * max(laps, 0)
        # What comes next is measured against this frame, bad or not: a counter that stands
        # still while the time goes on must not look like a lap after half a lap's time.
        self._keep(counter, self._ticks + passed, arrival)
        if steps == 0:
            return Flaw.REPEATED
        if passed <= 0:
            return Flaw.FROZEN
        return Passage(self._ticks * TIME_UNIT, steps - 1)

    def _unwrapped(self, steps: int, passed: int, arrival: float) -> int:
        """The node's time since the last frame: of those that differ by a wrap the nearest to the
        host's for which the counter has moved as far as it did.

        By the host's clock alone a frame that waited in a buffer would seem a wrap later than it
        is, and the first one after a buffer that was full a wrap earlier, long past. The counter
        alone would move a node that merely paused: none comes before it was sent, and none that
        goes back is believed but by the host's clock.
        """
        waited = (arrival - self._arrival) / TIME_UNIT
        near = round((waited - passed) / _WRAP)
        for wraps in (near, near - 1, near + 1, near - 2, near + 2):
            found = passed + _WRAP * wraps
            ahead = arrival - (self._ticks + found) * TIME_UNIT
            if wraps != near and (found <= 0 or ahead < self._ahead - _SHORT):
                continue
            off = found / self._step - steps
            if abs(off - COUNTS * round(off / COUNTS)) < _ALIKE:
                return found
        return passed + _WRAP * near

    def _keep(self, counter: int, ticks: int, arrival: float) -> None:
        ahead = arrival - ticks * TIME_UNIT
        # Clocks drift apart: by a part in a thousand at most.
        grown = self._ahead + _DRIFT * (arrival - self._arrival)
        self._ahead = ahead if ahead < grown else grown
        self._counter, self._ticks, self._arrival = counter, ticks, arrival
