"""Crossover and margin of a run's rider, where its scenario has a multisine."""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.crossover import (
    Margins,
    butterworth_response,
    delay_response,
    loop_of_roll_disturbance,
    loop_of_steer_disturbance,
    margins,
)
from bikesim.experiment.disturbances import Disturbance, harmonics
from bikesim.experiment.history import History
from bikesim.experiment.run import rig_inertia, scenario_bicycle
from bikesim.experiment.scenario import LawName, Scenario
from bikesim.experiment.spectra import line_amplitudes
from bikesim.haptics import HapticsSettings
from bikesim.model.law import Law
from bikesim.model.roll_response import Bar, roll_response
from bikesim.rig.settings import RigSettings

Complexes = NDArray[np.complex128]

SETTLING = 1 / 3
"""Share of the multisine's time that is left out, while the ride settles."""

_PERIODS = 2  # of the lowest line, at least, in what is left
_UNDEFINED = Margins(math.nan, math.nan)


def loop_margins(history: History, scenario: Scenario) -> Margins:
    """Of the loop that the rider closes, cut at his torque T_δ; see `crossover`.

    NaN without a single multisine, with too little of it before the end, where the speed or the
    haptic cue changes, and for a steer multisine that cannot be felt (haptics off).
    """
    multisine = _only_multisine(scenario)
    if multisine is None:
        return _UNDEFINED
    case = _Case.of(scenario, multisine)
    part = _window(history, multisine, case.frequencies)
    speed = history.speed[part]
    if not speed.size or np.ptp(speed) > 0.01 * speed[0]:
        return _UNDEFINED
    moment = history.roll_moment if case.on_roll else history.steer_moment
    signals = np.stack([history.rider_torque[part], history.roll[part], moment[part]])
    torque, roll, disturbance = line_amplitudes(
        history.time[part], signals, np.array(case.frequencies)
    )
    if case.on_roll:
        loop = loop_of_roll_disturbance(torque, roll, _plant(case, float(speed[0])))
    else:
        loop = loop_of_steer_disturbance(torque, disturbance * _feedback(case))
    return margins(np.array(case.frequencies), loop)


def _only_multisine(scenario: Scenario) -> Disturbance | None:
    found = [one for one in scenario.disturbances if one.kind.endswith("multisine")]
    changes = scenario.haptics.switches or scenario.rider.grips
    if len(found) != 1 or changes:
        return None
    unfelt = found[0].kind.startswith("steer") and scenario.law == "off"
    return None if unfelt else found[0]


def _window(history: History, multisine: Any, frequencies: tuple[float, ...]) -> slice:
    """The samples to look at; none if they are too few."""
    last = history.duration if multisine.stop is None else multisine.stop
    last = min(last, history.duration)
    first = multisine.start + SETTLING * (last - multisine.start)
    begin, end = np.searchsorted(history.time, [first, last])
    enough = _PERIODS * 2 * math.pi / frequencies[0]
    return slice(begin, end) if (end - begin) * history.period >= enough else slice(0, 0)


class _Case(NamedTuple):
    """What the plant and its lines depend on: equal for all runs of a condition."""

    frequencies: tuple[float, ...]
    on_roll: bool
    bicycle: str
    gravity: float | None
    law: LawName
    period: float
    rig: RigSettings
    haptics: HapticsSettings
    arms: tuple[float, float, float]

    @classmethod
    def of(cls, scenario: Scenario, multisine: Any) -> "_Case":
        rider = scenario.rider
        return cls(
            tuple(2 * math.pi / multisine.repeat * k for k in harmonics(multisine)),
            multisine.kind.startswith("roll"),
            scenario.bicycle,
            scenario.gravity,
            scenario.law,
            scenario.period,
            scenario.rig,
            scenario.haptics,
            (rider.arm_inertia or 0.0, rider.arm_damping or 0.0, rider.arm_stiffness or 0.0),
        )


@lru_cache(maxsize=1024)
def _plant(case: _Case, speed: float) -> Complexes:
    """φ/T_δ at the lines; friction of Coulomb's kind and limits are left out."""
    scenario = Scenario(bicycle=case.bicycle, gravity=case.gravity, law=case.law, rig=case.rig)
    bicycle, rig = scenario_bicycle(scenario), case.rig
    frequencies = np.array(case.frequencies)
    inertia, damping, stiffness = case.arms
    bar = Bar(
        rig_inertia(scenario, bicycle) + inertia,
        rig.viscous_friction + damping,
        stiffness,
        delay_response(frequencies, rig.sensor_delay)
        * butterworth_response(frequencies, rig.filter_cutoff, rig.filter_order),
        _feedback(case),
    )
    return roll_response(bicycle, Law(case.law), speed, bar, frequencies)


@lru_cache(maxsize=1024)
def _feedback(case: _Case) -> Complexes:
    """From the law's torque to that on the bar: cue, motor, and the hold of the sampled loop."""
    frequencies, cue, rig = np.array(case.frequencies), case.haptics, case.rig
    held = 0.5 * case.period
    return (
        cue.scale
        * delay_response(frequencies, cue.delay + rig.motor_delay + held, rig.motor_lag)
        * butterworth_response(frequencies, cue.filter_cutoff, cue.filter_order)
    )
