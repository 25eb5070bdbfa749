"""The best that any rider can do who steers by roll and roll rate."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.whipple import Matrix
from bikesim.rider.base import Arms
from bikesim.rider.linear import closed_loop, linear_rider, spectral_abscissa
from bikesim.rider.settings import RiderSettings

_START = (0.3, 0.7)  # N m/rad, N m s/rad: a soft rider's, see docs/paper.md


class BestRider(NamedTuple):
    """The gains [N m/rad], [N m s/rad] with the least growth rate [1/s]; stable below zero."""

    roll_gain: float
    roll_rate_gain: float
    growth_rate: float

    @property
    def gains(self) -> tuple[float, float]:
        """Roll gain, roll-rate gain."""
        return self.roll_gain, self.roll_rate_gain


class RollPDLoop:
    """Bicycle under a law with a roll PD rider of given arms and delay; his gains are free.

    The state matrix is affine in the gains, so it is assembled three times only. Neuromuscular
    figures are those of the default rider [H12].
    """

    def __init__(
        self, bicycle: Bicycle, speed: float, law: Law, *, delay: float, arms: Arms
    ) -> None:
        def matrix(roll_gain: float, roll_rate_gain: float) -> Matrix:
            settings = rider_settings(delay, arms, (roll_gain, roll_rate_gain))
            return closed_loop(bicycle, speed, linear_rider(settings), law=law)

        self._without = matrix(0.0, 0.0)
        self._per_roll = matrix(1.0, 0.0) - self._without
        self._per_roll_rate = matrix(0.0, 1.0) - self._without

    def growth_rate(self, gains: Iterable[float]) -> float:
        """The spectral abscissa [1/s] with these gains."""
        roll, roll_rate = gains
        return spectral_abscissa(
            self._without + roll * self._per_roll + roll_rate * self._per_roll_rate
        )

    def best(self, starts: Iterable[tuple[float, float]] = (_START,)) -> BestRider:
        """The gains, of any sign, with the least growth rate, searched from the best of `starts`.

        The growth rate has a kink wherever two modes are equally unstable, and its minimum lies in
        one: Nelder-Mead needs no slope. From wherever it starts it was seen to end at the same
        minimum, within 0.002 1/s.
        """
        from scipy.optimize import minimize

        start = min(starts, key=self.growth_rate)
        corners = np.array([start] * 3)
        corners[1:] += np.diag(0.1 + 0.3 * np.abs(start))
        found = minimize(
            self.growth_rate,
            corners[0],
            method="Nelder-Mead",
            options={"initial_simplex": corners, "xatol": 1e-4, "fatol": 1e-5, "maxfev": 400},
        )
        return BestRider(float(found.x[0]), float(found.x[1]), float(found.fun))


def rider_settings(delay: float, arms: Arms, gains: tuple[float, float]) -> RiderSettings:
    """The default rider with this delay [s], arms and gains, without noise."""
    return RiderSettings(
        name="human",
        roll_gain=gains[0],
        roll_rate_gain=gains[1],
        visual_delay=delay,
        arm_inertia=arms.inertia,
        arm_damping=arms.damping,
        arm_stiffness=arms.stiffness,
        remnant_rms=0.0,
    )
