"""The law as it is coded, taken apart into a state matrix: an independent look at its modes."""

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia
from bikesim.model.whipple import Matrix


def coded_state_matrix(
    bicycle: Bicycle, law: Law, speed: float, inertia: float | None = None
) -> Matrix:
    """d/dt of (φ, q, δ, δ̇) with nobody at the bar, 4 x 4, read off `HapticBicycle` itself.

    q is the momentum per M_φφ that the law integrates. Each column is what the law answers to a
    unit of one state, with eq. 5, I δ̈ = T_f, for the bar; `inertia` I [kg m²] is by default what
    the law asks for. Nothing of eq. 7 is used.
    """
    haptic = HapticBicycle(bicycle, law)
    M = bicycle.matrices.M
    m = float(M[0, 1] / M[0, 0]) if law is Law.MOMENTUM else 0.0
    if inertia is None:
        inertia = handlebar_inertia(bicycle, law)
    columns = []
    for roll, momentum, steer, steer_rate in np.eye(4).tolist():
        state = haptic.start(
            roll=roll,
            roll_rate=momentum - m * steer_rate,
            steer=steer,
            steer_rate=steer_rate,
            speed=speed,
        )
        columns.append(
            (state.roll_rate, state.roll_acceleration, steer_rate, state.feedback_torque / inertia)
        )
    return np.array(columns).T
