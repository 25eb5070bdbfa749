import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law


def test_a_circle_closes_and_has_the_radius_of_eq_8(benchmark: Bicycle):
    steer, speed, ticks = 0.1, 5.0, 2000
    radius = 1.02 / (steer * math.cos(math.pi / 10))
    haptic = HapticBicycle(benchmark, Law.PAPER)
    period = 2 * math.pi * radius / speed / ticks
    states = [haptic.start(steer=steer, speed=speed)]
    for tick in range(1, ticks + 1):
        states.append(haptic.step(states[-1], tick * period, steer, 0.0, speed))
    end = states[-1]
    assert end.heading == pytest.approx(2 * math.pi, rel=1e-6)
    assert math.hypot(end.x, end.y) < 1e-4
    assert max(state.y for state in states) == pytest.approx(2 * radius, rel=1e-5)
    assert end.distance == pytest.approx(2 * math.pi * radius, rel=1e-6)


def test_to_the_right_has_y_above_zero(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.PAPER)
    state = haptic.start(steer=0.1, speed=5.0)
    for tick in range(1, 101):
        state = haptic.step(state, tick * 0.01, 0.1, 0.0, 5.0)
    assert state.heading > 0
    assert state.y > 0


def test_at_rest_steering_turns_the_frame_by_its_trail(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.PAPER)
    state = haptic.step(haptic.start(), 0.1, 0.3, 3.0, 0.0)
    assert state.heading == pytest.approx(0.08 * 0.3 * math.cos(math.pi / 10) / 1.02)
    assert (state.x, state.y) == (0, 0)


def test_straight_ahead_goes_where_it_heads(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.PAPER)
    state = haptic.start(heading=math.pi / 6, speed=4.0)
    state = haptic.step(state, 2.0, 0.0, 0.0, 4.0)
    assert (state.x, state.y) == pytest.approx((8 * math.cos(math.pi / 6), 4.0))
    assert state.distance == pytest.approx(8.0)


def test_is_as_solve_ivp_follows_eq_8(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.PAPER)

    def steer(t: float) -> float:
        return 0.2 * math.sin(3 * t)

    def rate(t: float) -> float:
        return 0.6 * math.cos(3 * t)

    def speed(t: float) -> float:
        return 4 + t

    def slope(t: float, s: np.ndarray) -> list[float]:
        yaw = (speed(t) * steer(t) + 0.08 * rate(t)) * math.cos(math.pi / 10) / 1.02
        return [yaw, speed(t) * math.cos(s[0]), speed(t) * math.sin(s[0])]

    state = haptic.start(steer_rate=0.6, speed=4.0)
    for k in range(1, 2001):
        t = k * 1e-3
        state = haptic.step(state, t, steer(t), rate(t), speed(t))
    truth = solve_ivp(slope, (0, 2), [0, 0, 0], "DOP853", rtol=1e-10, atol=1e-11).y[:, -1]
    assert (state.heading, state.x, state.y) == pytest.approx(truth, abs=1e-5)
