"""Time as the loop sees it: simulated, which passes when it is told to, or real."""

import time
from collections.abc import Callable
from typing import NamedTuple


class SimulatedClock:
    """Time that passes when it is told to, in whole periods [s], without accumulated rounding."""

    def __init__(self, period: float) -> None:
        self._period = period
        self._ticks = 0
        self.now = 0.0

    def advance(self) -> None:
        """One period on."""
        self._ticks += 1
        self.now = self._ticks * self._period


class Wake(NamedTuple):
    """How a wait ended: `late` [s] after the deadline, and whole periods `skipped` on the way."""

    late: float
    skipped: int


class RealTimeClock:
    """Deadlines a period [s] apart from one start, on the monotonic clock.

    They do not move with what a tick took: a tick that is late does not make the next one late.
    Deadlines that are past already are skipped, never run through in a burst.
    """

    def __init__(
        self,
        period: float,
        *,
        clock: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._period, self._clock, self._sleep = period, clock, sleep
        self._ticks = 0
        self._start = clock()

    def start(self) -> None:
        """The first deadline is a period from now, which is time zero."""
        self._ticks, self._start = 0, self._clock()

    @property
    def now(self) -> float:
        """Time since the start [s], measured."""
        return self._clock() - self._start

    @property
    def left(self) -> float:
        """Time to the next deadline [s]; below zero where it is past."""
        return (self._ticks + 1) * self._period - self.now

    def wait(self) -> Wake:
        """Sleeps to the next deadline that is not yet past."""
        skipped = 0
        if self.left < 0:
            skipped = int(-self.left / self._period)
            self._ticks += skipped
        while (left := self.left) > 1e-9:  # [s]; what is less is rounding
            self._sleep(left)
        self._ticks += 1
        return Wake(self.now - self._ticks * self._period, skipped)
