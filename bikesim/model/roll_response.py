"""Roll that answers to a torque on the bar, over frequency: what a rider has to control."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]


class Bar(NamedTuple):
    """What turns at the rider's hands, how it is measured, how the feedback reaches it. SI.

    `inertia` of bar and arms [kg m²], `damping` of friction and arms [N m s/rad], `stiffness` of
    the arms [N m/rad]; `sensing` (n,) is the response from the steer to what the law is given,
    `feedback` (n,) that from T_f of the law to the torque on the bar.
    """

    inertia: float
    damping: float
    stiffness: float
    sensing: Complexes
    feedback: Complexes


def roll_response(
    bicycle: Bicycle, law: Law, speed: float, bar: Bar, frequencies: Reals
) -> Complexes:
    """φ/T_δ (n,) [rad/(N m)] of bicycle, law and bar at ω (n,) [rad/s], without the rider's loop.

    From eq. 4 or the momentum form, eq. 5 with the arms, and eq. 6.
    """
    s = 1j * frequencies
    (M_pp, M_pd), (M_dp, _) = bicycle.matrices.M
    (C_pp, C_pd), (C_dp, C_dd) = bicycle.matrices.damping(speed)
    (K_pp, K_pd), (K_dp, K_dd) = bicycle.matrices.stiffness(speed, bicycle.gravity)
    kept = M_pd if law is Law.MOMENTUM else 0.0
    roll_of_steer = -(kept * s**2 + C_pd * s + K_pd) / (M_pp * s**2 + C_pp * s + K_pp)
    acceleration = s**2 * (roll_of_steer + kept / M_pp)
    felt = M_dp * acceleration + (C_dp * s + K_dp) * roll_of_steer + C_dd * s + K_dd
    haptics = 0.0 if law is Law.OFF else bar.feedback * bar.sensing * felt
    on_bar = bar.inertia * s**2 + bar.damping * s + bar.stiffness + haptics
    return bar.sensing * roll_of_steer / on_bar
