"""The riders identified by Schwab, de Lange, Happee & Moore 2013 from lateral perturbations."""

from typing import NamedTuple

from bikesim.model.real import Real
from bikesim.rider.base import Setting, Sight


class IdentifiedRun(NamedTuple):
    """One identified run on the Davis bicycle: run number, speed [m/s], gains, variance explained.

    `roll` [N m/rad], `roll_rate` [N m s/rad], `steer_integral` [N m/(rad s)],
    `steer_rate` [N m s/rad], `variance_explained` [%].
    """

    run: int
    speed: float
    roll: float
    roll_rate: float
    steer_integral: float
    steer_rate: float
    variance_explained: float


# [S13], the table of the RiderID data set (CC-BY): columns ID, v, kpp, kpd, kdi, kdd, VAF.
IDENTIFIED_RUNS = tuple(
    IdentifiedRun(*row)
    for row in (
        (248, 2.15, 5.17, 27.21, 14.39, -1.92, 85.46),
        (249, 2.19, 28.97, 32.85, 29.02, -2.50, 94.89),
        (250, 2.19, 24.25, 32.51, 26.44, -2.57, 95.69),
        (184, 3.19, 22.72, 26.12, 65.92, -3.00, 95.09),
        (185, 3.18, 43.23, 30.45, 94.00, -3.21, 97.05),
        (186, 3.11, 31.12, 28.46, 71.26, -2.95, 97.06),
        (251, 4.27, 72.83, 32.44, 211.79, -3.81, 90.06),
        (252, 4.25, 41.51, 28.22, 177.45, -3.19, 95.18),
        (253, 4.25, 45.43, 28.99, 169.47, -3.60, 95.36),
        (190, 5.98, 34.19, 23.34, 334.82, -3.52, 96.94),
        (191, 6.06, 29.63, 22.83, 322.89, -3.81, 95.74),
        (192, 6.07, 28.32, 20.43, 293.30, -3.31, 92.04),
        (255, 7.32, 37.19, 26.66, 533.49, -5.37, 92.35),
        (256, 7.34, 48.65, 29.89, 583.43, -7.05, 90.09),
        (257, 7.36, 45.58, 26.97, 617.10, -4.64, 93.00),
    )
)


class IdentifiedRider:
    """T = k_φ φ + k_φ̇ φ̇ + k_∫ ∫δ dt + k_δ̇ δ̇ [S13].

    `roll_gain` [N m/rad], `roll_rate_gain` [N m s/rad], `steer_integral_gain` [N m/(rad s)],
    `steer_rate_gain` [N m s/rad]. Gains of an identified run are for the Davis bicycle at that
    run's speed: on another bicycle most of them are unstable.
    """

    def __init__(
        self,
        setting: Setting,
        *,
        roll_gain: Real = 0.0,
        roll_rate_gain: Real = 0.0,
        steer_integral_gain: Real = 0.0,
        steer_rate_gain: Real = 0.0,
    ) -> None:
        self._gains = roll_gain, roll_rate_gain, steer_integral_gain, steer_rate_gain
        self._step = setting.step
        self._steer_integral: Real = 0.0

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """The intended torque [N m]; see the class."""
        k_phi, k_phi_dot, k_integral, k_delta_dot = self._gains
        # A new object: what was added to must not change where it is kept.
        self._steer_integral = self._steer_integral + self._step * steer
        return (
            k_phi * seen.roll
            + k_phi_dot * seen.roll_rate
            + k_integral * self._steer_integral
            + k_delta_dot * steer_rate
        )
