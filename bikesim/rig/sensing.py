"""What a sensor makes of the truth: bias, noise, counts, filter."""

import math
from collections.abc import Iterator
from itertools import repeat
from typing import Self

import numpy as np

from bikesim.rig.filters import LowPass
from bikesim.rig.settings import RigSettings

_BLOCK = 1024


class Sensor:
    """A signal as its sensor and filter give it: value + bias + noise, in counts, low-passed."""

    def __init__(
        self,
        *,
        bias: float,
        noise: float,
        resolution: float,
        held: bool,
        low_pass: LowPass | None,
        random: np.random.Generator,
    ) -> None:
        """Bias, noise (standard deviation) and resolution in the signal's unit.

        `held`: the sensor converts less often than it is read, and a conversion has one noise.
        """
        self._held = held
        self._last_truth = self._last = math.nan
        self._bias, self._resolution, self._filter = bias, resolution, low_pass
        self._noise = _white(noise, random)
        self._exact = bias == noise == resolution == 0.0

    @classmethod
    def angle(cls, rig: RigSettings, period: float, random: np.random.Generator) -> Self:
        """The potentiometer of a rig, sampled with `period` [s]; [rad]."""
        return cls(
            bias=rig.angle_bias,
            noise=rig.angle_noise,
            resolution=rig.angle_resolution,
            held=rig.sensor_interval > period,
            low_pass=_low_pass(rig, period),
            random=random,
        )

    @classmethod
    def rate(cls, rig: RigSettings, period: float, random: np.random.Generator) -> Self:
        """The angular-rate sensor of a rig, sampled with `period` [s]; [rad/s]."""
        return cls(
            bias=rig.rate_bias,
            noise=rig.rate_noise,
            resolution=rig.rate_resolution,
            held=rig.sensor_interval > period,
            low_pass=_low_pass(rig, period),
            random=random,
        )

    def __call__(self, truth: float) -> float:
        """The measured value."""
        value = truth if self._exact else self._converted(truth)
        return self._filter(value) if self._filter else value

    def _converted(self, truth: float) -> float:
        if self._held and truth == self._last_truth:
            return self._last
        value = truth + self._bias + next(self._noise)
        if self._resolution:
            value = self._resolution * round(value / self._resolution)
        self._last_truth, self._last = truth, value
        return value


def _low_pass(rig: RigSettings, period: float) -> LowPass | None:
    if rig.filter_cutoff is None:
        return None
    return LowPass(rig.filter_cutoff, rig.filter_order, period)


def _white(deviation: float, random: np.random.Generator) -> Iterator[float]:
    if deviation == 0.0:
        yield from repeat(0.0)
    while True:
        yield from (deviation * random.standard_normal(_BLOCK)).tolist()
