import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from bikesim.bicycles import load
from bikesim.experiment.course import ScenarioCourse
from bikesim.experiment.moments import (
    BLOCK,
    DisturbanceMoments,
    moments_per_newton,
    multisines,
    push_force,
)
from bikesim.experiment.scenario import Push, Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.parameters import BicycleParameters
from bikesim.model.whipple import whipple_matrices

PUSH = Push(time=1.0, impulse=3.0, duration=0.2, height=0.8, ahead=0.4)


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return load("benchmark")


def _moments(bicycle: Bicycle, blocks: int, **keys: Any) -> np.ndarray:
    """T_φ and T_δ of the first ticks."""
    moments = DisturbanceMoments(Scenario(**keys), bicycle)
    return np.hstack([moments.block(number) for number in range(blocks)])


class TestPush:
    def test_its_force_integrates_to_the_impulse(self):
        total, _ = quad(lambda t: push_force(PUSH, t), 0.5, 2.0, points=[1.0, 1.2])
        assert total == pytest.approx(3.0, rel=1e-10)

    @pytest.mark.parametrize("time", [0.0, 0.999, 1.0, 1.2001, 99.0])
    def test_there_is_none_before_and_after(self, time: float):
        assert push_force(PUSH, time) == 0.0

    def test_it_is_strongest_in_its_middle(self):
        assert push_force(PUSH, 1.1) == pytest.approx(3.0 * math.pi / 0.4)

    @pytest.mark.parametrize("period", [1e-3, 5e-3, 20e-3])
    def test_sampled_by_the_loop_it_still_has_its_impulse(self, period: float):
        """What the model makes of it: straight lines between the ticks."""
        forces = [push_force(PUSH, k * period) for k in range(round(2 / period))]
        assert np.trapezoid(forces, dx=period) == pytest.approx(3.0, rel=0.01)

    def test_its_moments_are_those_of_a_weight_there(self, benchmark: Bicycle):
        """A small roll turns a mass m on the rear frame into a lateral force m g φ at its place:
        the terms that the mass adds to -g K0 are the moments of that force."""
        p = benchmark.parameters
        assert p is not None
        values = {name: getattr(p, name) for name in BicycleParameters.__slots__}
        heavier = BicycleParameters(**{**values, "mB": p.mB + 1.0})
        added = -(whipple_matrices(heavier).K0 - benchmark.matrices.K0)[0]
        moments = moments_per_newton(Push(time=0, impulse=1, height=-p.zB, ahead=p.xB), benchmark)
        assert (moments.roll, moments.steer) == pytest.approx(tuple(added), rel=1e-9)

    def test_a_short_one_gives_the_momentum_of_its_impulse(self, benchmark: Bicycle):
        """On the paper's law with the bar held: M_φφ Δφ̇ = height times impulse."""
        push = Push(time=0.01, impulse=2.0, duration=0.02, height=0.9)
        course = ScenarioCourse(Scenario(pushes=(push,)), benchmark)
        haptic = HapticBicycle(benchmark, Law.PAPER)
        state = haptic.start()
        for k in range(1, 41):
            moments = course.disturbance(k * 1e-3)
            state = haptic.step(state, k * 1e-3, 0.0, 0.0, 0.0, moments.roll, moments.steer)
        assert state.roll_rate == pytest.approx(0.9 * 2.0 / 80.81722, rel=0.01)

    def test_in_blocks_it_is_the_force_at_each_tick(self, benchmark: Bicycle):
        """Also over the edge of a block."""
        push = Push(time=0.98, impulse=3.0, duration=0.2)
        roll, steer = _moments(benchmark, 2, pushes=(push,))
        force = np.array([push_force(push, 1e-3 * k) for k in range(2 * BLOCK)])
        per_newton = moments_per_newton(push, benchmark)
        assert np.array_equal(roll, force * per_newton.roll)
        assert np.array_equal(steer, force * per_newton.steer)
        assert (force != 0).sum() in (199, 200)


class TestKinds:
    def test_a_roll_multisine_is_a_roll_torque(self, benchmark: Bicycle):
        one = {"kind": "roll-multisine", "torque_rms": 4.0, "repeat": BLOCK * 1e-3, "lowest": 7}
        roll, steer = _moments(benchmark, 1, disturbances=[{**one, "lines": 3, "highest": 40}])
        assert np.sqrt(np.mean(roll**2)) == pytest.approx(4.0)
        assert not steer.any()

    def test_a_steer_multisine_is_a_steer_torque(self, benchmark: Bicycle):
        roll, steer = _moments(benchmark, 1, disturbances=[{"kind": "steer-multisine"}])
        assert not roll.any()
        assert steer.any()

    def test_a_gust_pushes_at_its_point(self, benchmark: Bicycle):
        one = {"kind": "gust", "start": 0.1, "duration": 0.5, "height": 1.2, "ahead": 0.5}
        roll, steer = _moments(benchmark, 1, disturbances=[one])
        per_newton = moments_per_newton(Push(time=0, impulse=1, height=1.2, ahead=0.5), benchmark)
        assert roll.max() > 0
        assert steer == pytest.approx(roll * per_newton.steer / per_newton.roll)

    def test_faster_the_same_gust_is_stronger(self, benchmark: Bicycle):
        """F = ½ ρ c A √(v² + w²) w, at its peak of 5 m/s."""
        profile = ((0.0, 0.0), (1.0, 12.0))
        one = {"kind": "gust", "duration": 2.0, "height": 1.0}
        slow, _ = _moments(benchmark, 2, disturbances=[one], speed=0.0)
        fast, _ = _moments(benchmark, 2, disturbances=[one], speed=12.0)
        rising, _ = _moments(benchmark, 2, disturbances=[one], speed_profile=profile)
        assert slow[1000] == pytest.approx(0.5 * 1.225 * 0.7 * 25)
        assert fast[1000] / slow[1000] == pytest.approx(13 / 5)
        assert rising[1000] == pytest.approx(fast[1000], rel=1e-3)
        assert rising[0] == slow[0] == 0
        assert slow[500] < rising[500] < fast[500]

    def test_the_multisines_of_a_scenario_are_those_that_it_rides(self, benchmark: Bicycle):
        keys: dict[str, Any] = {
            "disturbances": [{"kind": "wind", "wind_rms": 0.0}, {"kind": "roll-multisine"}],
            "seed": 8,
        }
        roll, _ = _moments(benchmark, 1, **keys)
        ((kind, multisine),) = multisines(Scenario(**keys))
        assert kind == "roll-multisine"
        waves = multisine.frequencies[:, None] * 1e-3 * np.arange(BLOCK) + multisine.phases[:, None]
        assert roll == pytest.approx(multisine.amplitude * np.sin(waves).sum(axis=0), abs=1e-12)
