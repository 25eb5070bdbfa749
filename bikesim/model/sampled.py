"""The haptic loop as it is sampled: what its period and delay make of the bicycle's modes."""

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia
from bikesim.model.whipple import Matrix


def sampled_eigenvalues(
    bicycle: Bicycle,
    law: Law,
    speed: float,
    *,
    period: float,
    delay_periods: int = 0,
    inertia: float | None = None,
    arm_damping: float = 0.0,
    arm_stiffness: float = 0.0,
) -> np.ndarray:
    """Equivalent continuous eigenvalues s = ln(z)/T [1/s] of the sampled loop, least stable first.

    The bar of `inertia` [kg m²] (by default what the law asks for; add the arms' own) moves in
    continuous time under a torque held over each period T [s]; the law runs on samples of angle
    and rate, by its own first-order hold. `delay_periods` whole periods pass from sample to torque:
    0 is a torque sent in the tick that measured, held for one period. Modes with z = 0
    (the delay line's own) are left out. `arm_damping` [N m s/rad] and `arm_stiffness` [N m/rad]
    act between bar and frame.
    """
    if inertia is None:
        inertia = handlebar_inertia(bicycle, law)
    loop = _LoopMatrix(HapticBicycle(bicycle, law), speed, period, delay_periods)
    z = np.linalg.eigvals(loop.matrix(inertia, arm_damping, arm_stiffness)).astype(complex)
    s = np.log(z[np.abs(z) > 1e-6]) / period
    return s[np.argsort(-s.real)]


class _LoopMatrix:
    """One period of the loop as a matrix on (δ, δ̇, the law's state, torques under way)."""

    def __init__(
        self, haptic: HapticBicycle, speed: float, period: float, delay_periods: int
    ) -> None:
        self._haptic, self._speed, self._period = haptic, speed, period
        self._delay = delay_periods

    def matrix(self, inertia: float, damping: float, stiffness: float) -> Matrix:
        size = 7 + self._delay
        return np.column_stack(
            [self._advance(column, inertia, damping, stiffness) for column in np.eye(size)]
        )

    def _advance(
        self, state: np.ndarray, inertia: float, damping: float, stiffness: float
    ) -> np.ndarray:
        """From tick to tick: the bar under the oldest torque, then the law on the new sample."""
        bar, (roll, momentum, e, f), torques = state[:2], state[2:6], state[6:]
        hold, drive = _bar_transition(inertia, damping, stiffness, self._period)
        bar = hold @ bar + drive * torques[0]
        rest = self._haptic.start(speed=self._speed)
        before = rest._replace(roll=roll, momentum=momentum, roll_forcing=e, momentum_forcing=f)
        now = self._haptic.step(before, self._period, float(bar[0]), float(bar[1]), self._speed)
        law = (now.roll, now.momentum, now.roll_forcing, now.momentum_forcing)
        return np.array([*bar, *law, *torques[1:], now.feedback_torque])


def _bar_transition(
    inertia: float, damping: float, stiffness: float, period: float
) -> tuple[Matrix, np.ndarray]:
    """Exact motion of I δ̈ + b δ̇ + k δ = T over one period of constant torque."""
    from scipy.linalg import expm

    generator = np.zeros((3, 3))
    generator[0, 1] = 1.0
    generator[1] = [-stiffness / inertia, -damping / inertia, 1.0 / inertia]
    moved = expm(generator * period)
    return moved[:2, :2], moved[:2, 2]
