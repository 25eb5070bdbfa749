"""A rider from his settings."""

import numpy as np

from bikesim.rider.base import Arms, Rider
from bikesim.rider.hands_off import HandsOff
from bikesim.rider.muscle import Neuromuscular, remnant
from bikesim.rider.roll_pd import RollPD
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS, IdentifiedRider
from bikesim.rider.settings import RiderSettings, identified_run


def make_rider(settings: RiderSettings, step: float, random: np.random.Generator) -> Rider:
    """The rider of resolved settings, for a physics step [s], with his own source of noise."""
    if settings.name == "hands-off":
        return HandsOff()
    muscle = Neuromuscular(
        _figure(settings.muscle_frequency), _figure(settings.muscle_damping_ratio), step
    )
    noise = remnant(
        _figure(settings.remnant_rms), _figure(settings.remnant_bandwidth), step, random
    )
    arms = Arms(
        _figure(settings.arm_inertia),
        _figure(settings.arm_damping),
        _figure(settings.arm_stiffness),
    )
    number = identified_run(settings.name)
    if number is not None:
        gains = next(run for run in IDENTIFIED_RUNS if run.run == number)
        return IdentifiedRider(gains, muscle=muscle, noise=noise, arms=arms, step=step)
    return RollPD(
        roll_gain=_figure(settings.roll_gain),
        roll_rate_gain=_figure(settings.roll_rate_gain),
        delay_steps=round(_figure(settings.visual_delay) / step),
        muscle=muscle,
        noise=noise,
        arms=arms,
    )


def _figure(value: float | None) -> float:
    assert value is not None, "settings must be resolved"
    return value
