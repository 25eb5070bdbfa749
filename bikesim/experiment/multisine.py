"""A multisine: a sum of sines of known frequencies, the same power in each."""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.disturbances import Disturbance, harmonics

Array = NDArray[np.float64]


class Multisine:
    """T(t) = Σ a sin(ω_i (t - start) + θ_i) with a = rms √(2 / lines), from start to stop.

    `frequencies` ω_i [rad/s]; `phases` θ_i [rad], at `start`: random, or Schroeder's (1970, eq. 11)
    for lines of one power, -π i (i - 1) / lines for i = 1, 2, …
    """

    def __init__(self, settings: Disturbance, period: float, random: np.random.Generator) -> None:
        """Asked for at times a `period` [s] apart."""
        s: Any = settings  # the figures of a multisine are there
        self.frequencies: Array = 2 * np.pi / s.repeat * np.array(harmonics(settings), float)
        self.phases = random.uniform(0.0, 2 * np.pi, s.lines)
        if s.phases == "schroeder":
            i = np.arange(1, s.lines + 1)
            self.phases = -np.pi * i * (i - 1) / s.lines
        self._frequencies, self._period = tuple(self.frequencies.tolist()), period
        self.amplitude = s.torque_rms * math.sqrt(2 / s.lines)
        self._start = s.start
        self._stop = math.inf if s.stop is None else s.stop

    def __call__(self, time: Array) -> Array:
        """The torque [N m] at times (n,) [s], a period apart."""
        torque = np.zeros(len(time))
        if time[-1] < self._start or time[0] >= self._stop:
            return torque
        since = float(time[0]) - self._start
        waves = _waves(self._frequencies, self._period, len(time))
        for frequency, phase, (sin, cos) in zip(
            self._frequencies, self.phases.tolist(), waves, strict=True
        ):
            first = frequency * since + phase
            torque += math.sin(first) * cos + math.cos(first) * sin
        torque *= self.amplitude
        torque[(time < self._start) | (time >= self._stop)] = 0.0
        return torque


@lru_cache(maxsize=64)
def _waves(frequencies: tuple[float, ...], period: float, count: int) -> list[tuple[Array, Array]]:
    """Sine and cosine of each frequency, from zero on: shared by all blocks and runs."""
    later = period * np.arange(count)
    return [(np.sin(frequency * later), np.cos(frequency * later)) for frequency in frequencies]
