"""The sampled loop that a virtual rig closes, for its margins."""

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.sampled_loop import SampledLoop
from bikesim.model.simulator import handlebar_inertia
from bikesim.rig.settings import RigSettings


def rig_loop(rig: RigSettings, bicycle: Bicycle, law: Law, period: float) -> SampledLoop:
    """Of a rig's figures and a loop `period` [s]; Coulomb friction, counts, noise and limits are
    no part of a linear loop.
    """
    return SampledLoop(
        rig.inertia or handlebar_inertia(bicycle, law),
        period,
        rig.sensor_delay + rig.motor_delay,
        rig.motor_lag,
        rig.sensor_interval,
        rig.filter_cutoff,
        rig.filter_order,
        rig.viscous_friction,
    )
