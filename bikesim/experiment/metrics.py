"""What a run came to in figures: one row of an experiment's table."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.handling import handling_quality_peak
from bikesim.experiment.history import History
from bikesim.experiment.loop_margins import loop_margins
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.spectra import (
    band_power,
    centroid_frequency,
    median_frequency,
    welch,
)
from bikesim.experiment.steering import reversals, work
from bikesim.experiment.tracking import deviations
from bikesim.path.building import make_path

Reals = NDArray[np.float64]

REVERSAL_GAP = math.radians(2.0)
"""Steer angle of a reversal [rad]."""

BANDS = (0.0, 0.5, 2.0, math.inf)
"""Edges of the bands of the rider's torque [Hz]: path, balance, tremor."""


class Metrics(NamedTuple):
    """The metrics of a run: see METRICS for what each is. NaN where it is not defined."""

    fell: float
    fall_time: float
    duration: float
    roll_rms: float
    roll_rate_rms: float
    steer_rms: float
    steer_rate_rms: float
    feedback_torque_rms: float
    rider_torque_rms: float
    lateral_rms: float
    lateral_mean: float
    sdlp: float
    lateral_max: float
    work_net: float
    work_positive: float
    steer_reversals: float
    saturated: float
    torque_power_low: float
    torque_power_middle: float
    torque_power_high: float
    torque_median_frequency: float
    torque_centroid_frequency: float
    crossover_frequency: float
    phase_margin: float
    handling_quality: float


def measure(history: History, scenario: Scenario) -> Metrics:
    """The metrics of a run of a scenario; a run has at least one tick."""
    ending, duration = history.ending, history.duration
    lateral = deviations(history, make_path(scenario.path))
    net, positive = work(history.rider_torque, history.true_steer_rate, history.period)
    spectrum = _torque_spectrum(history.rider_torque, history.period)
    loop = loop_margins(history, scenario)
    return Metrics(
        fell=float(ending.fell),
        fall_time=math.nan if ending.fall_time is None else ending.fall_time,
        duration=duration,
        roll_rms=rms(history.roll),
        roll_rate_rms=rms(history.roll_rate),
        steer_rms=rms(history.true_steer),
        steer_rate_rms=rms(history.true_steer_rate),
        feedback_torque_rms=rms(history.sent_torque),
        rider_torque_rms=rms(history.rider_torque),
        lateral_rms=rms(lateral),
        lateral_mean=float(lateral.mean()),
        sdlp=float(lateral.std()),
        lateral_max=float(np.abs(lateral).max()),
        work_net=net,
        work_positive=positive,
        steer_reversals=reversals(history.true_steer, REVERSAL_GAP) / duration,
        saturated=saturated(history.sent_torque, *_torque_limit(scenario)),
        torque_power_low=spectrum.low,
        torque_power_middle=spectrum.middle,
        torque_power_high=spectrum.high,
        torque_median_frequency=spectrum.median,
        torque_centroid_frequency=spectrum.centroid,
        crossover_frequency=loop.crossover_frequency,
        phase_margin=loop.phase_margin,
        handling_quality=handling_quality_peak(scenario),
    )


def measure_many(histories: Sequence[History], scenarios: Sequence[Scenario]) -> list[Metrics]:
    """The metrics of many runs, in order."""
    return [measure(*one) for one in zip(histories, scenarios, strict=True)]


def rms(values: Reals) -> float:
    """Root mean square of (m,)."""
    return math.sqrt(float(values @ values) / len(values))


def saturated(torque: Reals, limit: float, resolution: float) -> float:
    """Share of (m,) at a limit [N m], or less than a count [N m] from it."""
    return float(np.mean(np.abs(torque) >= limit - max(resolution, 1e-9 * limit)))


def _torque_limit(scenario: Scenario) -> tuple[float, float]:
    """The smallest of the limits on the feedback torque [N m], and the rig's count [N m]."""
    limits = (scenario.guard.torque_limit, scenario.rig.torque_limit, scenario.haptics.limit)
    return min(limit for limit in limits if limit is not None), scenario.rig.torque_resolution


class _TorqueSpectrum(NamedTuple):
    low: float
    middle: float
    high: float
    median: float
    centroid: float


def _torque_spectrum(torque: Reals, period: float) -> _TorqueSpectrum:
    """Power in each of BANDS, median and centroid; NaN for a run shorter than a segment."""
    spectrum = welch(torque, period)
    if spectrum is None or not math.isfinite(float(spectrum.density.sum())):
        return _TorqueSpectrum(*(math.nan,) * 5)
    low, middle, high = (band_power(spectrum, *edges) for edges in pairwise(BANDS))
    return _TorqueSpectrum(
        low, middle, high, median_frequency(spectrum), centroid_frequency(spectrum)
    )
