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
    """How a wait ended: `late` [s] after the deadline that it served, `skipped` those before it."""

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
        """Sleeps to the next deadline; serves the newest one that is past by then.

        However it came to be late, by a long tick or by a sleep that was too long.
        """
        while (left := self.left) > 1e-9:  # [s]; what is less is rounding
            self._sleep(left)
        past = max(-left, 0.0)
        skipped = int(past / self._period)
        self._ticks += 1 + skipped
        return Wake(past - skipped * self._period, skipped)
