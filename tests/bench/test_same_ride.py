"""Virtual rig and emulated bench: the same rider and seed give the same ride."""

import math

import numpy as np
import pytest

from bikesim.bench.profile import BenchSettings
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Push, Scenario
from bikesim.rig.base import Rig

from .lockstep import DRIVES, NAMES, LockStep, Rows, profile


def at_once(bench: BenchSettings) -> BenchSettings:
    """At 1 s of ramping in, the torque of the bench is another than that of the virtual rig."""
    thresholds = bench.thresholds.model_copy(update={"ramp_in": 1e-6})
    return bench.model_copy(update={"thresholds": thresholds})


@pytest.mark.parametrize(("kind", "duration"), [("cia402", 30.0), ("odrive", 12.0)])
def test_the_roll_agrees_within_two_tenths_of_a_degree(kind: str, duration: float):
    pushed = Scenario(duration=duration, pushes=(Push(time=2.0, impulse=4.0),))
    bench = LockStep(at_once(profile(DRIVES[kind])), pushed)
    assert bench.ride().reason == "end of run"
    virtual = Rows()
    ride_parts(build(bench.order.scenario), virtual)
    n = len(virtual)
    assert n == 1000 * duration
    ours, theirs = (
        np.array([row[:17] for row in bench.rows[:n]]),
        np.array([r[:17] for r in virtual]),
    )
    assert np.abs(ours[:, 0] - theirs[:, 0]).max() < 1e-6
    roll = NAMES.index("roll")
    assert math.degrees(np.abs(theirs[:, roll]).max()) > 4.0
    assert math.degrees(np.abs(ours[:, roll] - theirs[:, roll]).max()) < 0.2


@pytest.mark.parametrize("kind", DRIVES)
def test_a_bench_is_a_rig(kind: str):
    rig: Rig = LockStep(profile(DRIVES[kind]), Scenario()).parts.rig
    assert len(rig.info.channels) == 9
    rig.read()
    rig.command(0.0)
    assert len(rig.telemetry()) == len(rig.info.channels)
    rig.wait()
    rig.close()
    rig.close()
