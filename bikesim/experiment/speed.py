"""The forward speed of a scenario."""

from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.scenario import Scenario


class SpeedProfile:
    """Constant, or piecewise linear; before the first and after the last given time, that one's."""

    def __init__(self, scenario: Scenario) -> None:
        self._constant = scenario.speed
        self._times = [time for time, _ in scenario.speed_profile]
        self._speeds = [speed for _, speed in scenario.speed_profile]

    def __call__(self, time: float) -> float:
        """[m/s] at a time [s]."""
        if not self._times:
            return self._constant
        return _interpolated(time, self._times, self._speeds)

    def at(self, time: NDArray[np.float64]) -> NDArray[np.float64] | float:
        """[m/s] at times (n,) [s]; a float where it is always the same."""
        if not self._times:
            return self._constant
        return np.array([self(t) for t in time.tolist()])


def _interpolated(x: float, xs: Sequence[float], ys: Sequence[float]) -> float:
    i = bisect_right(xs, x)
    if i == 0:
        return ys[0]
    if i == len(xs):
        return ys[-1]
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])
