"""The haptic loop as it is sampled: what its period and delay make of the bicycle's modes."""

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.margins import sampled_modes
from bikesim.model.sampled_loop import Grip, SampledLoop, controller
from bikesim.model.simulator import handlebar_inertia


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
    act between bar and frame. A loop with more in it: `sampled_loop.SampledLoop`.
    """
    if inertia is None:
        inertia = handlebar_inertia(bicycle, law)
    loop = SampledLoop(inertia, period, delay_periods * period)
    grip = Grip(0.0, arm_damping, arm_stiffness)
    return sampled_modes(controller(bicycle, law, speed, loop), loop, grip)
