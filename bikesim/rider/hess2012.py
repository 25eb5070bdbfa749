"""The rider of Hess, Moore & Hubbard 2012: five loops, one around the other, and a path."""

import math

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.base import Setting, Sight
from bikesim.rider.hess_gains import Gains, published_gains, published_speeds

PREVIEW = 2.75  # s, of riding that he looks ahead of the front wheel [H12]
_PATH_FILTER = 2.4  # rad/s, twice: 2.4² / (s + 2.4)² [H12]


class Hess2012:
    """T = k_δ (δ_c - δ), and each command comes from the loop around it [H12]:

        δ_c = k_φ̇ (φ̇_c - φ̇),  φ̇_c = k_φ (φ_c - φ),  φ_c = k_ψ (ψ_c - ψ),  ψ_c = k_y (y_c - y_q)

    y_q = y_p + w ψ - c δ cos λ is the lateral position of the front contact, y_c that of the path
    PREVIEW ahead of it (no farther than the display shows), through 2.4²/(s + 2.4)². The model's
    neuromuscular lag, 30 rad/s with damping ratio 0.707, is not here but in his muscles.

    The model is one of small headings. On a path here its lateral coordinate is the integral of the
    path's heading over the station, and y_p that plus the deviation: along +x and in a lane change
    this is the model as published. Where the heading goes on growing, as on a circle, ψ_c must grow
    with it, which only a growing y_c - y_q can bring about: he rides metres outside a circle.

    A gain left at NaN is the published one for the bicycle and the speed. It follows a speed that
    changes, up to the ends of what is published; the start must be inside (else InputError).
    """

    def __init__(
        self,
        setting: Setting,
        *,
        k_delta: Real = math.nan,
        k_phi_dot: Real = math.nan,
        k_phi: Real = math.nan,
        k_psi: Real = math.nan,
        k_y: Real = math.nan,
    ) -> None:
        bicycle = setting.bicycle
        self._bicycle = bicycle
        self._path = setting.path
        self._wheelbase = bicycle.wheelbase
        self._trail = bicycle.trail * math.cos(bicycle.steer_axis_tilt)
        self._preview = _within(setting.preview, 0.0, PREVIEW)
        self._filter = None if setting.path.straight else _PathFilter(setting.step)
        self._target: Real = 0.0
        self._seen: Sight | None = None
        self._given = Gains(k_delta, k_phi_dot, k_phi, k_psi, k_y)
        unknown = np.any(np.broadcast_arrays(*map(np.isnan, self._given)), axis=0)
        self._speeds: tuple[float, float] | None = None  # of the published gains, if they are used
        if unknown.any():
            self._speeds = published_speeds(bicycle)
            speed, unknown = np.broadcast_arrays(setting.speed, unknown)
            published_gains(bicycle, speed[unknown])
        self._take(setting.speed)

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """One physics step; see the class."""
        if seen is not self._seen:
            self._look(seen)
        to_the_right = self._trail * steer - self._front
        if self._filter is not None:
            to_the_right = to_the_right + self._filter(self._target)
        return self._gains.steer * (self._path_gain * to_the_right - self._balance - steer)

    def _look(self, seen: Sight) -> None:
        """What a sight changes; between two of them only the steer and the path's filter move."""
        self._seen = seen
        if self._speeds is not None and _differ(seen.speed, self._speed):
            self._take(seen.speed)
        y_p, psi, path = seen.deviation, seen.heading, self._path
        if self._filter is not None:
            y_p = y_p + path.lateral(seen.station)
            ahead = seen.station + self._wheelbase + seen.speed * self._preview
            self._target = path.lateral(ahead)
            self._filter.begin(y_p)
        self._front = y_p + self._wheelbase * psi
        _, k_phi_dot, k_phi, k_psi, _ = self._gains
        self._balance = k_phi_dot * (k_phi * (k_psi * psi + seen.roll) + seen.roll_rate)

    def _take(self, speed: Real) -> None:
        """The gains at a speed [m/s]."""
        gains = self._given
        if self._speeds is not None:
            published = published_gains(self._bicycle, _within(speed, *self._speeds))
            gains = Gains(*map(_first_known, gains, published))
        self._speed, self._gains = speed, gains
        self._path_gain = gains.roll_rate * gains.roll * gains.heading * gains.lateral


class _PathFilter:
    """2.4²/(s + 2.4)², exact for a target held over the step [s]; it begins at rest."""

    def __init__(self, step: float) -> None:
        moved = _PATH_FILTER * step
        decay = math.exp(-moved)
        self._matrix = (
            (1 + moved) * decay, step * decay, -_PATH_FILTER * moved * decay, (1 - moved) * decay,
        )  # fmt: skip
        self._y: Real = None
        self._rate: Real = 0.0

    def begin(self, y: Real) -> None:
        """The first value [m]; once begun, nothing."""
        if self._y is None:
            self._y = y

    def __call__(self, target: Real) -> Real:
        """The filtered target [m], then a step further."""
        P11, P12, P21, P22 = self._matrix
        y, rate = self._y, self._rate
        self._y = target + P11 * (y - target) + P12 * rate
        self._rate = P21 * (y - target) + P22 * rate
        return y


def _within(value: Real, least: float, most: float) -> Real:
    if isinstance(value, np.ndarray):
        return np.minimum(np.maximum(value, least), most)
    return min(max(value, least), most)


def _differ(a: Real, b: Real) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return a is not b and bool(np.any(a != b))
    return a != b


def _first_known(given: Real, published: Real) -> Real:
    if isinstance(given, np.ndarray):
        return np.where(np.isnan(given), published, given)
    return published if math.isnan(given) else given
