"""Hess's handling-quality metric of a scenario's rider."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bikesim.errors import InputError
from bikesim.experiment.run import scenario_bicycle
from bikesim.experiment.scenario import LawName, Scenario
from bikesim.model.law import Law
from bikesim.rider.base import Arms
from bikesim.rider.hess_gains import Gains, published_gains
from bikesim.rider.hess_loops import handling_quality, linear_hess
from bikesim.rider.linear import closed_loop, spectral_abscissa
from bikesim.rider.settings import RiderSettings

FREQUENCIES = np.linspace(0.01, 40.0, 400)
"""Where the largest is looked for [rad/s], as in [Moore, Hubbard & Hess 2016]."""


def handling_quality_peak(scenario: Scenario) -> float:
    """The largest HQM over FREQUENCIES of Hess's rider at the scenario's first speed.

    On the simulator under the scenario's law, muscle and arms his own, delays and haptic cues left
    out. NaN of other riders, and where his inner loops are not stable.
    """
    if scenario.rider.name != "hess2012":
        return math.nan
    return _peak(_Case.of(scenario))


class _Case(NamedTuple):
    """What the metric depends on: equal for all runs of a condition."""

    bicycle: str
    gravity: float | None
    law: LawName
    inertia: float | None
    speed: float
    gains: tuple[float | None, ...]
    muscle: tuple[float, float]
    arms: Arms

    @classmethod
    def of(cls, scenario: Scenario) -> "_Case":
        rider, profile = scenario.rider, scenario.speed_profile
        return cls(
            scenario.bicycle,
            scenario.gravity,
            scenario.law,
            scenario.rig.inertia,
            profile[0][1] if profile else scenario.speed,
            (rider.k_delta, rider.k_phi_dot, rider.k_phi, rider.k_psi, rider.k_y),
            (rider.muscle_frequency or 30.0, rider.muscle_damping_ratio or 0.707),
            _arms(rider),
        )


def _arms(rider: RiderSettings) -> Arms:
    return Arms(rider.arm_inertia or 0.0, rider.arm_damping or 0.0, rider.arm_stiffness or 0.0)


@lru_cache(maxsize=4096)
def _peak(case: _Case) -> float:
    bicycle = scenario_bicycle(
        Scenario(bicycle=case.bicycle, gravity=case.gravity, speed=case.speed)
    )
    try:
        gains = _gains(case, lambda: published_gains(bicycle, case.speed))
    except InputError:
        return math.nan
    law = Law(case.law)
    inner = Gains(gains.steer, gains.roll_rate, gains.roll, 0.0, 0.0)
    rider = linear_hess(bicycle, inner, case.speed, muscle=case.muscle, arms=case.arms)
    loop = closed_loop(bicycle, case.speed, rider, law=law, inertia=case.inertia)
    # Heading and lateral position, whose loops are open, are integrators: roots at zero.
    if spectral_abscissa(loop) > 1e-6:
        return math.nan
    quality = handling_quality(
        bicycle, gains, case.speed, FREQUENCIES, law,
        inertia=case.inertia, muscle=case.muscle, arms=case.arms,
    )  # fmt: skip
    return float(quality.max())


def _gains(case: _Case, published) -> Gains:
    given = case.gains
    known = published() if None in given else Gains(*(math.nan,) * 5)
    return Gains(*(k if g is None else g for g, k in zip(given, known, strict=True)))
