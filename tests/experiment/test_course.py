import math

import numpy as np
import pytest
from scipy.integrate import quad

from bikesim.bicycles import load
from bikesim.experiment.course import ScenarioCourse, moments_per_newton, push_force
from bikesim.experiment.scenario import Push, Scenario
from bikesim.loop import Moments
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.parameters import BicycleParameters
from bikesim.model.whipple import whipple_matrices

PUSH = Push(time=1.0, impulse=3.0, duration=0.2, height=0.8, ahead=0.4)


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return load("benchmark")


class TestSpeed:
    def test_is_constant_without_a_profile(self, benchmark: Bicycle):
        course = ScenarioCourse(Scenario(speed=4.2), benchmark)
        assert {course.speed(t) for t in (0.0, 3.0, 1e6)} == {4.2}

    def test_is_linear_between_the_given_times_and_constant_outside(self, benchmark: Bicycle):
        profile = ((1.0, 2.0), (3.0, 6.0), (4.0, 5.0))
        course = ScenarioCourse(Scenario(speed_profile=profile), benchmark)
        times = [0.0, 1.0, 1.5, 2.9, 3.0, 3.25, 4.0, 99.0]
        expected = np.interp(times, [time for time, _ in profile], [speed for _, speed in profile])
        assert [course.speed(t) for t in times] == pytest.approx(expected)

    def test_of_one_given_time_is_constant(self, benchmark: Bicycle):
        course = ScenarioCourse(Scenario(speed_profile=((1.0, 2.0),)), benchmark)
        assert [course.speed(t) for t in (0.0, 1.0, 2.0)] == [2.0, 2.0, 2.0]


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

    def test_several_add_up(self, benchmark: Bicycle):
        one, two = (ScenarioCourse(Scenario(pushes=(PUSH,) * n), benchmark) for n in (1, 2))
        single, double = one.disturbance(1.1), two.disturbance(1.1)
        assert double == pytest.approx((2 * single.roll, 2 * single.steer))

    def test_without_one_nothing_pushes(self, benchmark: Bicycle):
        assert ScenarioCourse(Scenario(), benchmark).disturbance(1.0) == Moments(0, 0)

    def test_to_the_right_leans_right(self, benchmark: Bicycle):
        course = ScenarioCourse(Scenario(pushes=(PUSH,)), benchmark)
        assert course.disturbance(1.1).roll > 0

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
