"""The steady turn: what roll and torque hold a constant steer angle."""

import math
from typing import NamedTuple

from bikesim.model.bicycle import Bicycle


class SteadyTurn(NamedTuple):
    """Ratios of a steady turn per unit of steer angle, linearised; signs of [M07].

    `roll_per_steer` [rad/rad], `steer_torque_per_steer` [N m/rad] (the rider's), and
    `yaw_rate_per_steer` [(rad/s)/rad].
    """

    roll_per_steer: float
    steer_torque_per_steer: float
    yaw_rate_per_steer: float


def steady_turn(bicycle: Bicycle, speed: float) -> SteadyTurn:
    """K (φ, δ) = (0, T_δ) with constant φ and δ at a forward speed [m/s] [M07, Sec. 5].

    Where K_φφ = 0 (no gravity) no roll holds a turn: its ratio is infinite, the torque's is nan.
    """
    stiffness = bicycle.matrices.stiffness(speed, bicycle.gravity)
    (K_pp, K_pd), (K_dp, K_dd) = stiffness.tolist()
    roll = -K_pd / K_pp if K_pp != 0 else math.copysign(math.inf, K_pd)
    return SteadyTurn(
        roll_per_steer=roll,
        steer_torque_per_steer=K_dd + K_dp * roll,
        yaw_rate_per_steer=speed * math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase,
    )
