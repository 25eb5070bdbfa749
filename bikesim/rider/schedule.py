"""A value that changes at given times."""

from bisect import bisect_right
from collections.abc import Sequence
from math import inf

import numpy as np

from bikesim.model.real import Real

Changes = Sequence[tuple[float, float]]


class Schedule:
    """A value by the time; another object only when it has changed.

    `first`, then from each time [s] on the value beside it. For a batch the changes of `each`
    rider: where they differ the value is an array (n,).
    """

    def __init__(self, first: float, each: Sequence[Changes]) -> None:
        times = sorted({time for changes in each for time, _ in changes})
        values = [[_at(time, first, changes) for changes in each] for time in (-inf, *times)]
        same = all(changes == each[0] for changes in each)
        self._values: list[Real] = [row[0] if same else np.array(row) for row in values]
        self._ends = [*times, inf]
        self._now = 0

    def __call__(self, time: float) -> Real:
        """The value at a time [s], which must not fall from call to call."""
        while time >= self._ends[self._now]:
            self._now += 1
        return self._values[self._now]


def _at(time: float, first: float, changes: Changes) -> float:
    past = bisect_right([when for when, _ in changes], time)
    return changes[past - 1][1] if past else first
