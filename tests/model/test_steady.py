import math

import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.steady import steady_turn


@pytest.mark.parametrize("speed", [1.0, 3.5, 7.0])
def test_a_bicycle_in_a_steady_turn_stays_in_it(benchmark: Bicycle, speed: float):
    steer, haptic = 0.05, HapticBicycle(benchmark, Law.PAPER)
    roll = steady_turn(benchmark, speed).roll_per_steer * steer
    state = haptic.start(steer=steer, roll=roll, speed=speed)
    for tick in range(1, 501):
        state = haptic.step(state, tick * 1e-3, steer, 0.0, speed)
    assert state.roll == pytest.approx(roll, rel=1e-10)
    assert state.roll_acceleration == pytest.approx(0, abs=1e-10)


@pytest.mark.parametrize("law", [Law.PAPER, Law.MOMENTUM])
def test_the_rider_holds_against_the_feedback_torque(benchmark: Bicycle, law: Law):
    turn, steer = steady_turn(benchmark, 3.5), 0.05
    state = HapticBicycle(benchmark, law).start(
        steer=steer, roll=turn.roll_per_steer * steer, speed=3.5
    )
    assert state.feedback_torque == pytest.approx(-turn.steer_torque_per_steer * steer, rel=1e-12)


def test_at_the_capsize_speed_no_torque_is_needed(benchmark: Bicycle):
    """[M07]: there det K = 0, so the bicycle keeps any turn by itself."""
    turn = steady_turn(benchmark, 6.02426201538837)
    assert turn.steer_torque_per_steer == pytest.approx(0, abs=1e-12)


def test_a_fast_bicycle_leans_into_the_turn(benchmark: Bicycle):
    assert steady_turn(benchmark, 5.0).roll_per_steer > 0


def test_the_yaw_rate_is_that_of_eq_8(benchmark: Bicycle):
    ratio = steady_turn(benchmark, 5.0).yaw_rate_per_steer
    assert ratio == pytest.approx(5.0 * math.cos(math.pi / 10) / 1.02)


def test_without_gravity_no_lean_holds_a_turn(benchmark: Bicycle):
    turn = steady_turn(benchmark.with_gravity(0.0), 5.0)
    assert turn.roll_per_steer == math.inf
    assert math.isnan(turn.steer_torque_per_steer)
