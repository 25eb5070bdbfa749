"""Wind from the side, and its force: a gust that swells and goes, and turbulence.

The force is the drag of bicycle and rider in the air that comes at them, of which the part to the
side counts: F = ½ ρ c A √(v² + w²) w, with the side wind w and the speed v.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.disturbances import Disturbance

Array = NDArray[np.float64]

AIR_DENSITY = 1.225  # kg/m³, ISO 2533: sea level, 15 °C
_SLOWEST = 1.0  # m/s; a bicycle that stands sees turbulence pass at a walk


def side_force(settings: Disturbance, wind: Array, speed: Array | float) -> Array:
    """[N], to the right, of a side wind [m/s] at a forward speed [m/s]."""
    s: Any = settings  # the figures of a wind are there
    return 0.5 * AIR_DENSITY * s.drag_area * np.sqrt(speed * speed + wind * wind) * wind


class Gust:
    """w(t) = peak (1 - cos(2π (t - start) / duration)) / 2: the discrete gust of MIL-F-8785C."""

    def __init__(self, settings: Disturbance) -> None:
        s: Any = settings
        self._start, self._duration, self._peak = s.start, s.duration, s.wind_peak

    def __call__(self, time: Array) -> Array:
        """The side wind [m/s] at times (n,) [s]."""
        phase = np.clip((time - self._start) / self._duration, 0.0, 1.0)
        return 0.5 * self._peak * (1 - np.cos(2 * np.pi * phase))


class Turbulence:
    """Dryden's lateral turbulence (MIL-F-8785C, 3.7.1): noise through the filter

    H(s) = σ √(τ/π) (1 + √3 τ s) / (1 + τ s)²,   τ = scale length / speed,

    sampled exactly. With τ ṗ = n - p and τ q̇ = p - q it is (√3 p + (1 - √3) q) σ / √2, for noise
    that gives p the variance 1; q then has ½, and both together ½.
    """

    def __init__(
        self, settings: Disturbance, speed: float, period: float, random: np.random.Generator
    ) -> None:
        """Carried by at a `speed` [m/s], a value every `period` [s]."""
        from scipy.special import gammainc

        s: Any = settings
        step = period * max(speed, _SLOWEST) / s.wind_length
        self._decay, self._pass = math.exp(-step), step * math.exp(-step)
        # What a step adds to the covariance of p and q: 2 ∫ exp(-2u) (1, u, u²) du.
        pp, pq, qq = gammainc([1, 2, 3], 2 * step) * [1, 0.5, 0.5]
        self._drive = np.linalg.cholesky([[pp, pq], [pq, qq]])
        self._start, self._stop = s.start, math.inf if s.stop is None else s.stop
        self._rms, self._random = s.wind_rms, random
        first, second = random.standard_normal(2)
        self._p, self._q = first, 0.5 * (first + second)

    def __call__(self, time: Array) -> Array:
        """The side wind [m/s] at the next times (n,) [s]; every one must be asked for in turn."""
        from scipy.signal import lfilter

        noise = self._random.standard_normal((len(time), 2)).T
        driven_p, driven_q = (
            self._drive[0, 0] * noise[0],
            self._drive[1, 0] * noise[0] + self._drive[1, 1] * noise[1],
        )
        back = [1.0, -self._decay]
        p, _ = lfilter([1.0], back, driven_p, zi=[self._decay * self._p])
        before = np.concatenate([[self._p], p[:-1]])
        q, _ = lfilter([1.0], back, self._pass * before + driven_q, zi=[self._decay * self._q])
        self._p, self._q = p[-1], q[-1]
        wind = self._rms / math.sqrt(2) * (math.sqrt(3) * p + (1 - math.sqrt(3)) * q)
        wind[(time < self._start) | (time >= self._stop)] = 0.0
        return wind
