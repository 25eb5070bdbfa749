import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law

from .conftest import LAWS, Measured, rides


def roll_by_solve_ivp(
    bicycle: Bicycle, law: Law, measured: Measured, roll: float, roll_rate: float
) -> tuple[float, float]:
    """Roll and roll rate at the last sample, from the equations of SCIENCE as they stand.

    What the steer does to the roll is a straight line between the samples, each at its own
    speed. (What the roll does to itself does not depend on the speed of a Whipple bicycle.)
    """
    M = bicycle.matrices.M
    M_pd = M[0, 1] if law is Law.MOMENTUM else 0.0
    m = measured

    def forcing(k: int) -> float:
        C = bicycle.matrices.damping(m.speed[k])
        K = bicycle.matrices.stiffness(m.speed[k], bicycle.gravity)
        roll_rate = -M_pd / M[0, 0] * m.steer_rate[k]
        return m.roll_moment[k] - (
            C[0, 0] * roll_rate + C[0, 1] * m.steer_rate[k] + K[0, 1] * m.steer[k]
        )

    x = np.array([roll, M[0, 0] * roll_rate + M_pd * m.steer_rate[0]])
    for k in range(1, len(m.time)):
        C_pp = bicycle.matrices.damping(m.speed[k])[0, 0]
        K_pp = bicycle.matrices.stiffness(m.speed[k], bicycle.gravity)[0, 0]
        ends = m.time[[k - 1, k]]
        rates, forces = m.steer_rate[[k - 1, k]], (forcing(k - 1), forcing(k))

        def slope(t: float, x: np.ndarray, now=(C_pp, K_pp, ends, rates, forces)) -> list[float]:
            C_pp, K_pp, ends, rates, forces = now
            free = -C_pp * x[1] / M[0, 0] - K_pp * x[0]
            return [
                (x[1] - M_pd * np.interp(t, ends, rates)) / M[0, 0],
                free + np.interp(t, ends, forces),
            ]

        x = solve_ivp(slope, tuple(ends), x, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return float(x[0]), float((x[1] - M_pd * m.steer_rate[-1]) / M[0, 0])


def sinusoid_error(bicycle: Bicycle, law: Law, period: float) -> float:
    """Open-loop roll error [rad] after 2 s at 3.5 m/s of 5 degrees of steer at 1 Hz."""
    amplitude, omega, speed = math.radians(5), 2 * math.pi, 3.5
    haptic = HapticBicycle(bicycle, law)

    def bar(t: float) -> tuple[float, float]:
        return amplitude * math.sin(omega * t), amplitude * omega * math.cos(omega * t)

    state = haptic.start(steer=0.0, steer_rate=amplitude * omega, speed=speed)
    for k in range(1, round(2 / period) + 1):
        state = haptic.step(state, k * period, *bar(k * period), speed)

    C = bicycle.matrices.damping(speed)
    K = bicycle.matrices.stiffness(speed, bicycle.gravity)
    M = bicycle.matrices.M

    def slope(t: float, x: np.ndarray) -> list[float]:
        steer, rate = bar(t)
        inertial = M[0, 1] * -(omega**2) * steer if law is Law.MOMENTUM else 0.0
        force = inertial + C[0, 1] * rate + K[0, 0] * x[0] + K[0, 1] * steer
        return [x[1], -force / M[0, 0]]

    truth = solve_ivp(slope, (0, 2), [0, 0], "DOP853", rtol=1e-12, atol=1e-13).y[0, -1]
    return abs(state.roll - truth)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("seed", [1, 2])
def test_is_exact_for_interpolated_steer_at_uneven_periods_and_speeds(
    benchmark: Bicycle, law: Law, seed: int
):
    measured = Measured(seed)
    last = rides(HapticBicycle(benchmark, law), measured, roll=0.02, roll_rate=-0.1)[-1]
    roll, roll_rate = roll_by_solve_ivp(benchmark, law, measured, 0.02, -0.1)
    assert last.roll == pytest.approx(roll, abs=1e-10)
    assert last.roll_rate == pytest.approx(roll_rate, abs=1e-10)


@pytest.mark.parametrize("law", LAWS)
def test_is_exact_for_a_bicycle_with_roll_damping(damped_roll: Bicycle, law: Law):
    measured = Measured(3)
    last = rides(HapticBicycle(damped_roll, law), measured, roll=0.02, roll_rate=-0.1)[-1]
    roll, roll_rate = roll_by_solve_ivp(damped_roll, law, measured, 0.02, -0.1)
    assert last.roll == pytest.approx(roll, abs=1e-10)
    assert last.roll_rate == pytest.approx(roll_rate, abs=1e-10)


def test_is_exact_over_a_missed_second(benchmark: Bicycle):
    measured = Measured(4, samples=3, longest=2.5)
    last = rides(HapticBicycle(benchmark, Law.PAPER), measured)[-1]
    roll, _ = roll_by_solve_ivp(benchmark, Law.PAPER, measured, 0.0, 0.0)
    assert last.roll == pytest.approx(roll, rel=1e-9)


def test_open_loop_error_of_sinusoidal_steer(benchmark: Bicycle):
    """2.8e-3 degrees, where the held input of a common integrator gives 0.60."""
    error = math.degrees(sinusoid_error(benchmark, Law.PAPER, 1e-3))
    assert error == pytest.approx(2.8e-3, abs=5e-5)


@pytest.mark.parametrize("law", LAWS)
def test_error_falls_with_the_square_of_the_period(benchmark: Bicycle, law: Law):
    coarse, fine = (sinusoid_error(benchmark, law, period) for period in (0.02, 0.01))
    assert coarse / fine == pytest.approx(4, rel=0.02)


def test_a_speed_that_changes_converges_to_the_bicycle_that_speeds_up(benchmark: Bicycle):
    haptic, m = HapticBicycle(benchmark, Law.PAPER), benchmark.matrices

    def speed(t: float) -> float:
        return 3 + 1.5 * t

    def ridden(period: float) -> float:
        state = haptic.start(steer=0.02, speed=3.0)
        for k in range(1, round(2 / period) + 1):
            state = haptic.step(state, k * period, 0.02, 0.0, speed(k * period))
        return state.roll

    def slope(t: float, x: np.ndarray) -> list[float]:
        K = m.stiffness(speed(t), benchmark.gravity)
        return [x[1], -(K[0, 0] * x[0] + K[0, 1] * 0.02) / m.M[0, 0]]

    truth = solve_ivp(slope, (0, 2), [0, 0], "DOP853", rtol=1e-11, atol=1e-12).y[0, -1]
    coarse, fine = (abs(ridden(period) - truth) for period in (2e-3, 1e-3))
    assert fine < 1e-3 * abs(truth)
    assert fine < 0.6 * coarse


@pytest.mark.parametrize("law", LAWS)
def test_no_time_changes_no_roll(benchmark: Bicycle, law: Law):
    haptic = HapticBicycle(benchmark, law)
    state = haptic.start(roll=0.1, roll_rate=0.2, steer=0.05, steer_rate=0.3, speed=4.0)
    again = haptic.step(state, 0.0, 0.05, 0.3, 4.0)
    assert again == state


@pytest.mark.parametrize("law", LAWS)
def test_the_start_is_as_given(benchmark: Bicycle, law: Law):
    state = HapticBicycle(benchmark, law).start(
        time=3.0, roll=0.1, roll_rate=0.2, steer=0.05, steer_rate=0.3, heading=1.0, speed=4.0
    )
    assert state.roll == 0.1
    assert state.roll_rate == pytest.approx(0.2, abs=1e-16)
    assert (state.time, state.heading, state.x, state.y, state.distance) == (3, 1, 0, 0, 0)


def test_a_lean_to_the_right_falls_to_the_right(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.PAPER)
    state = haptic.step(haptic.start(roll=0.01), 0.1, 0.0, 0.0, 0.0)
    assert state.roll_rate > 0


def test_steering_right_leans_left(benchmark: Bicycle):
    """Countersteering."""
    haptic = HapticBicycle(benchmark, Law.PAPER)
    state = haptic.step(haptic.start(speed=5.0), 0.1, 0.05, 0.5, 5.0)
    assert state.roll < 0
