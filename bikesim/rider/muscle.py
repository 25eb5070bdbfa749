"""What lies between a rider's intention and his torque: muscles, and noise."""

import math
from collections.abc import Iterator

import numpy as np

from bikesim.model.transition import transition

_BLOCK = 4096


class Neuromuscular:
    """G_nm(s) = ω² / (s² + 2 ζ ω s + ω²), exact for input held over a step.

    `frequency` ω [rad/s], `damping_ratio` ζ, `step` [s]. Published: ω about 30 rad/s [H12].
    """

    def __init__(self, frequency: float, damping_ratio: float, step: float) -> None:
        stiffness, damping = frequency**2, 2 * damping_ratio * frequency
        P11, P12, P21, P22, _, A12, _, A22, _, B12, _, B22 = transition(step, stiffness, damping)
        self._matrix = P11, P12, P21, P22, stiffness * (A12 + B12), stiffness * (A22 + B22)
        self._torque = self._torque_rate = 0.0

    def __call__(self, intended: float) -> float:
        """The torque after one step of the intended torque [N m]."""
        P11, P12, P21, P22, D1, D2 = self._matrix
        torque, rate = self._torque, self._torque_rate
        self._torque = P11 * torque + P12 * rate + D1 * intended
        self._torque_rate = P21 * torque + P22 * rate + D2 * intended
        return self._torque


def remnant(
    rms: float, bandwidth: float, step: float, random: np.random.Generator
) -> Iterator[float]:
    """Torque noise [N m] that the rider's law does not explain: white, through a first-order lag.

    `rms` [N m] and `bandwidth` [rad/s] hold whatever the step [s] (exact Ornstein-Uhlenbeck); it
    starts in its stationary distribution.
    """
    decay = math.exp(-bandwidth * step)
    kick = rms * math.sqrt(1 - decay**2)
    value = rms * float(random.standard_normal())
    while True:
        for normal in random.standard_normal(_BLOCK).tolist():
            yield value
            value = decay * value + kick * normal
