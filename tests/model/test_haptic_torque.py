import numpy as np
import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law

from .conftest import LAWS, Measured, rides


def test_is_eq_6_with_the_algebraic_acceleration_of_eq_4(benchmark: Bicycle):
    m = benchmark.matrices
    for state in rides(HapticBicycle(benchmark, Law.PAPER), Measured(5), roll=0.02)[1:]:
        C, K = m.damping(state.speed), m.stiffness(state.speed, benchmark.gravity)
        q, q_dot = (state.roll, state.steer), (state.roll_rate, state.steer_rate)
        moment = Measured(5).roll_moment[Measured(5).time == state.time][0]
        acceleration = (moment - C[0] @ q_dot - K[0] @ q) / m.M[0, 0]
        assert state.roll_acceleration == pytest.approx(acceleration, abs=1e-12)
        torque = -(m.M[1, 0] * acceleration + C[1] @ q_dot + K[1] @ q)
        assert state.feedback_torque == pytest.approx(torque, abs=1e-12)


@pytest.mark.parametrize("name", ["benchmark", "damped_roll"])
def test_of_the_momentum_law_moves_the_bar_as_the_bicycles_own(
    request: pytest.FixtureRequest, name: str
):
    """With I δ̈ = T_f + T_δ the bar has the steer acceleration of the full bicycle."""
    bicycle: Bicycle = request.getfixturevalue(name)
    m = bicycle.matrices
    inertia = np.linalg.det(m.M) / m.M[0, 0]
    for state in rides(HapticBicycle(bicycle, Law.MOMENTUM), Measured(6), roll=0.02)[1:]:
        C, K = m.damping(state.speed), m.stiffness(state.speed, bicycle.gravity)
        q, q_dot = (state.roll, state.steer), (state.roll_rate, state.steer_rate)
        moment = Measured(6).roll_moment[Measured(6).time == state.time][0]
        accelerations = np.linalg.solve(m.M, (moment, 0) - C @ q_dot - K @ q)
        assert state.feedback_torque / inertia == pytest.approx(accelerations[1], abs=1e-10)


def test_with_haptics_off_is_zero(benchmark: Bicycle):
    states = rides(HapticBicycle(benchmark, Law.OFF), Measured(7), roll=0.1)
    assert {state.feedback_torque for state in states} == {0.0}


def test_with_haptics_off_the_bicycle_rolls_as_ever(benchmark: Bicycle):
    off, on = (rides(HapticBicycle(benchmark, law), Measured(7)) for law in (Law.OFF, Law.PAPER))
    assert [state.roll for state in off] == [state.roll for state in on]


@pytest.mark.parametrize("law", LAWS)
def test_carries_a_disturbance_on_the_steer(benchmark: Bicycle, law: Law):
    haptic = HapticBicycle(benchmark, law)
    without, with_it = (
        haptic.start(roll=0.1, speed=4.0, steer_moment=moment) for moment in (0.0, 1.5)
    )
    assert with_it.feedback_torque - without.feedback_torque == pytest.approx(1.5)


def test_the_disturbance_on_the_roll_accelerates_it(benchmark: Bicycle):
    state = HapticBicycle(benchmark, Law.PAPER).start(roll_moment=80.81722)
    assert state.roll_acceleration == pytest.approx(1.0, rel=1e-12)


def test_grows_with_rate_noise_as_0_713_v(benchmark: Bicycle):
    """N m per rad/s of steer rate; SCIENCE, Sec. 5."""
    haptic = HapticBicycle(benchmark, Law.PAPER)
    torque = haptic.start(steer_rate=1.0, speed=3.5).feedback_torque
    assert abs(torque) == pytest.approx(0.713 * 3.5, abs=2e-3)
