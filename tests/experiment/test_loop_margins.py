"""Crossover and margin from rides, against the linear loop of the same riders."""

import math
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.experiment.crossover import Margins, margins
from bikesim.experiment.history import History
from bikesim.experiment.loop_margins import loop_margins
from bikesim.experiment.scenario import Scenario
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.record.reader import Run
from bikesim.rider.linear import linear_rider

ROLL = {"kind": "roll-multisine", "torque_rms": 1.0, "highest": 12.0}
STEER = {"kind": "steer-multisine", "torque_rms": 0.05, "highest": 25.0}


@pytest.fixture
def found(ridden: Callable[..., Run]) -> Callable[..., Margins]:
    """The margins of a ride of a scenario with these keys."""

    def find(**keys: Any) -> Margins:
        run = ridden(**{"duration": 60.0, "period": 0.002, "physics_step": 0.001, **keys})
        scenario = Scenario(**tomllib.loads(run.scenario))
        return loop_margins(History.of_run(run), scenario)

    return find


def linear(**keys: Any) -> Margins:
    """L = -R x/T_δ of the rider's state space and [SR13, eq. 7], without sampling."""
    scenario = Scenario(**keys)
    rider, bicycle = linear_rider(scenario.rider), bicycles.load(scenario.bicycle)
    M, C, K = simulator_matrices(bicycle, Law(scenario.law), scenario.speed)
    on_bar = np.diag([0.0, 1.0])
    frequencies = np.geomspace(0.6, 25, 2000)
    loop = []
    for w in frequencies:
        s = 1j * w
        a = rider.arms
        passive = a.inertia * s * s + a.damping * s + a.stiffness
        q = np.linalg.solve(M * s * s + C * s + K + passive * on_bar, [0, 1])
        seen = np.array([q[0], q[1], s * q[0], s * q[1]])
        response = np.linalg.solve(s * np.eye(len(rider.A)) - rider.A, rider.B @ seen)
        loop.append(-rider.C @ response)
    return margins(frequencies, np.array(loop))


@pytest.mark.parametrize("disturbance", [ROLL, STEER], ids=lambda one: one["kind"])
def test_a_rider_who_steers_by_roll(disturbance: dict[str, Any], found):
    rider = {"name": "human", "remnant_rms": 0.0}
    margin = found(rider=rider, disturbances=[disturbance])
    expected = linear(rider=rider)
    assert margin.crossover_frequency == pytest.approx(expected.crossover_frequency, rel=0.03)
    assert margin.phase_margin == pytest.approx(expected.phase_margin, abs=math.radians(3))


def test_a_rider_who_also_steers_by_steer_is_found_by_a_steer_disturbance(found):
    keys: dict[str, Any] = {"bicycle": "davis", "speed": 3.19, "rider": "schwab2013-184"}
    margin = found(**keys, disturbances=[STEER])
    expected = linear(**keys)
    assert margin.crossover_frequency == pytest.approx(expected.crossover_frequency, rel=0.03)
    assert margin.phase_margin == pytest.approx(expected.phase_margin, abs=math.radians(3))


def test_noise_that_does_not_go_with_the_disturbance_drops_out(found):
    rider = {"name": "human", "remnant_rms": 0.01}
    margin = found(rider=rider, disturbances=[{**ROLL, "torque_rms": 3.0}])
    expected = linear(rider=rider)
    assert margin.crossover_frequency == pytest.approx(expected.crossover_frequency, rel=0.1)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"disturbances": [ROLL, STEER]},
        {"disturbances": [STEER], "law": "off"},
        {"disturbances": [ROLL], "haptics": {"switches": [[5.0, 0.5]]}},
        {"disturbances": [ROLL], "speed_profile": [[0.0, 3.5], [60.0, 4.0]]},
        {"disturbances": [{**ROLL, "stop": 25.0}]},
    ],
    ids=["none", "two", "unfelt", "switched", "speeding", "short"],
)
def test_where_it_is_not_defined(keys: dict[str, Any], made_up):
    scenario = Scenario(duration=60.0, **keys)
    wave = np.sin(0.05 * np.arange(6000))
    speed = np.linspace(3.5, 4.0 if "speed_profile" in keys else 3.5, 6000)
    history = made_up(60, rider_torque=wave, roll=wave, roll_moment=wave, speed=speed)
    assert all(math.isnan(value) for value in loop_margins(history, scenario))
