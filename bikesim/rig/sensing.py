"""What a sensor makes of the truth: bias, noise, counts, filter."""

import math
from collections.abc import Iterator, Sequence
from itertools import repeat
from typing import Self

import numpy as np

from bikesim.model.low_pass import LowPass
from bikesim.model.real import Real
from bikesim.rig.settings import RigSettings

_BLOCK = 1024

# The source of a rig's noise; of a batch's, one for each rig, which gives it what it has alone.
Random = np.random.Generator | Sequence[np.random.Generator]


class Sensor:
    """A signal as its sensor and filter give it: value + bias + noise, in counts, low-passed.

    Takes floats, or arrays with a value for each rig of a batch.
    """

    def __init__(
        self,
        *,
        bias: float,
        noise: float,
        resolution: float,
        held: bool,
        low_pass: LowPass | None,
        random: Random,
    ) -> None:
        """Bias, noise (standard deviation) and resolution in the signal's unit.

        `held`: the sensor converts less often than it is read, and a conversion has one noise.
        """
        self._held = held
        self._last_truth: Real = math.nan
        self._last: Real = math.nan
        self._bias, self._resolution, self._filter = bias, resolution, low_pass
        self._noise = _white(noise, random)
        self._exact = bias == noise == resolution == 0.0

    @classmethod
    def angle(cls, rig: RigSettings, period: float, random: Random) -> Self:
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
    def rate(cls, rig: RigSettings, period: float, random: Random) -> Self:
        """The angular-rate sensor of a rig, sampled with `period` [s]; [rad/s]."""
        return cls(
            bias=rig.rate_bias,
            noise=rig.rate_noise,
            resolution=rig.rate_resolution,
            held=rig.sensor_interval > period,
            low_pass=_low_pass(rig, period),
            random=random,
        )

    def __call__(self, truth: Real) -> Real:
        """The measured value."""
        value = truth if self._exact else self._converted(truth)
        return self._filter(value) if self._filter else value

    def _converted(self, truth: Real) -> Real:
        # Drawn at every reading, used or not: a noise that depends on the motion could not be
        # drawn for a whole batch at once.
        value = truth + self._bias + next(self._noise)
        if self._resolution:
            value = self._resolution * _rounded(value / self._resolution)
        if self._held:
            value = _chosen(truth == self._last_truth, self._last, value)
        self._last_truth, self._last = truth, value
        return value


def _rounded(value: Real) -> Real:
    """To the nearest whole number; what is not finite stays what it is, for the guard to see."""
    if isinstance(value, float):
        return float(round(value)) if math.isfinite(value) else value
    return np.rint(value) + 0.0  # no negative zero, as round() has none


def _chosen(condition: Real, this: Real, other: Real) -> Real:
    if isinstance(condition, bool):
        return this if condition else other
    return np.where(condition, this, other)


def _low_pass(rig: RigSettings, period: float) -> LowPass | None:
    if rig.filter_cutoff is None:
        return None
    return LowPass(rig.filter_cutoff, rig.filter_order, period, "rig.filter_cutoff")


def _white(deviation: float, random: Random) -> Iterator[Real]:
    if deviation == 0.0:
        yield from repeat(0.0)
    while True:
        if isinstance(random, np.random.Generator):
            yield from (deviation * random.standard_normal(_BLOCK)).tolist()
        else:
            each = [deviation * one.standard_normal(_BLOCK) for one in random]
            yield from np.stack(each, axis=1)
