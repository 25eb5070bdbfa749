"""Signals that arrive late."""

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.model.real import Real

# A NamedTuple of floats or arrays (n,).
Signals = Any
Late = Callable[[Signals], Signals]


def delay_of_all(steps: int, before: Signals) -> Late:
    """The same delay, in steps, for all: gives what came in so many calls ago."""
    line = deque([before] * steps)
    push, pop = line.append, line.popleft

    def late(now: Signals) -> Signals:
        push(now)
        return pop()

    return late


class DelayOfEach:
    """A delay, in steps, for each rider of a batch.

    Signals that come in again, as a sight does at all steps of a tick, are not kept again.
    """

    def __init__(self, steps: list[int], before: Signals) -> None:
        self._made, self._riders = type(before)._make, np.arange(len(steps))
        self._delays = sorted(set(steps))
        self._which = np.array([self._delays.index(one) for one in steps])
        length = self._delays[-1] + 1
        self._kept = np.empty((length + 1, len(before), len(steps)))
        self._offsets = (len(steps) * np.arange(len(before)))[:, None]
        self._numbers = [0] * length  # by step: which of those kept came in
        self._step = self._number = 0
        self._late_numbers = [0] * len(self._delays)
        self._last = before
        self._keep(before)
        self._late = self._gathered(np.array(self._late_numbers))

    def __call__(self, now: Signals) -> Signals:
        """For each rider what came in as many calls ago as he has steps."""
        if now is not self._last:
            self._last, self._number = now, (self._number + 1) % len(self._kept)
            self._keep(now)
        numbers, step = self._numbers, self._step
        numbers[step] = self._number
        self._step = (step + 1) % len(numbers)
        # A negative index counts from the end: it is what came in before this turn of the ring.
        late = [numbers[step - delay] for delay in self._delays]
        if late != self._late_numbers:
            self._late_numbers, self._late = late, self._gathered(np.array(late))
        return self._late

    def _keep(self, signals: Signals) -> None:
        for row, signal in zip(self._kept[self._number], signals, strict=True):
            row[:] = signal

    def _gathered(self, numbers: NDArray[np.int_]) -> Signals:
        first = numbers[self._which] * self._kept[0].size + self._riders
        return self._made(self._kept.reshape(-1).take(self._offsets + first))


def delay_line(delay: Real, step: float, before: Signals) -> Late | None:
    """A line of a delay [s], rounded to whole steps [s], or of an array of them; None for none.

    `before`: what comes out until the first signals have passed.
    """
    if np.ndim(delay) == 0:
        steps = round(delay / step)
        return delay_of_all(steps, before) if steps else None
    return DelayOfEach([round(one / step) for one in delay.tolist()], before)
