"""What lies between a rider's intention and his torque."""

import numpy as np

from bikesim.model.real import Real
from bikesim.model.transition import transition
from bikesim.rider.figures import elementwise


class Neuromuscular:
    """G_nm(s) = ω² / (s² + 2 ζ ω s + ω²), exact for input held over a step.

    `frequency` ω [rad/s], `damping_ratio` ζ, `step` [s]. Published: ω about 30 rad/s [H12].
    Floats, or arrays with a value for each rider of a batch; `many`: the torques are arrays.
    """

    def __init__(
        self, frequency: Real, damping_ratio: Real, step: float, *, many: bool = False
    ) -> None:
        matrix = elementwise(lambda w, z: _matrix(w, z, step), frequency, damping_ratio)
        # NumPy multiplies an array by an array of no dimensions faster than by a float.
        self._matrix = tuple(map(np.asarray, matrix)) if many else matrix
        self._torque: Real = 0.0
        self._torque_rate: Real = 0.0

    def follow(self, intended: Real) -> Real:
        """The torque after one step of the intended torque [N m]."""
        P11, P12, P21, P22, D1, D2 = self._matrix
        torque, rate = self._torque, self._torque_rate
        self._torque = P11 * torque + P12 * rate + D1 * intended
        self._torque_rate = P21 * torque + P22 * rate + D2 * intended
        return self._torque

    def relax(self, which: Real) -> None:
        """Back to rest: True or False, or a mask (n,) of those who relax."""
        self._torque = _rested(which, self._torque)
        self._torque_rate = _rested(which, self._torque_rate)


def _rested(which: Real, value: Real) -> Real:
    if isinstance(which, bool):
        return 0.0 if which else value
    return np.where(which, 0.0, value)


def _matrix(frequency: float, damping_ratio: float, step: float) -> tuple[float, ...]:
    stiffness, damping = frequency**2, 2 * damping_ratio * frequency
    P11, P12, P21, P22, _, A12, _, A22, _, B12, _, B22 = transition(step, stiffness, damping)
    return P11, P12, P21, P22, stiffness * (A12 + B12), stiffness * (A22 + B22)


class Strength:
    """No torque beyond a limit [N m], either side; a float, or an array (n,)."""

    def __init__(self, limit: Real) -> None:
        self._limit = limit

    def __call__(self, intended: Real) -> Real:
        """What of the intended torque [N m] he has in his arms."""
        if isinstance(intended, float) and isinstance(self._limit, float):
            return min(max(intended, -self._limit), self._limit)
        return np.minimum(np.maximum(intended, -self._limit), self._limit)
