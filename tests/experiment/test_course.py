from typing import Any

import numpy as np
import pytest

from bikesim.bicycles import load
from bikesim.experiment.course import BatchCourse, ScenarioCourse
from bikesim.experiment.moments import BLOCK
from bikesim.experiment.scenario import Scenario
from bikesim.loop import Moments
from bikesim.model.bicycle import Bicycle

PUSH = {"time": 1.0, "impulse": 3.0, "duration": 0.2, "height": 0.8, "ahead": 0.4}
EACH_KIND = [
    {"kind": "roll-multisine"},
    {"kind": "steer-multisine", "start": 0.5, "stop": 1.5, "phases": "schroeder"},
    {"kind": "wind", "wind_rms": 2.0},
    {"kind": "gust", "start": 1.0},
]


def _scenario(**keys: Any) -> Scenario:
    return Scenario(**keys)


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


class TestDisturbance:
    def test_several_add_up(self, benchmark: Bicycle):
        one, two = (ScenarioCourse(_scenario(pushes=[PUSH] * n), benchmark) for n in (1, 2))
        single, double = one.disturbance(1.1), two.disturbance(1.1)
        assert double == pytest.approx((2 * single.roll, 2 * single.steer))

    def test_without_one_nothing_pushes(self, benchmark: Bicycle):
        assert ScenarioCourse(Scenario(), benchmark).disturbance(1.0) == Moments(0, 0)

    def test_to_the_right_leans_right(self, benchmark: Bicycle):
        for keys in ({"pushes": [PUSH]}, {"disturbances": [{"kind": "gust"}]}):
            course = ScenarioCourse(_scenario(**keys), benchmark)
            assert course.disturbance(1.1).roll > 0

    def test_is_a_function_of_time(self, benchmark: Bicycle):
        """In whatever order it is asked, back as well as forth."""
        scenario = _scenario(disturbances=EACH_KIND, pushes=[PUSH])
        forth, to_and_fro = (ScenarioCourse(scenario, benchmark) for _ in range(2))
        times = [1e-3 * k for k in range(0, 4 * BLOCK, 100)]
        inorder = {t: forth.disturbance(t) for t in times}
        for t in np.random.default_rng(5).permutation(times).tolist():
            assert to_and_fro.disturbance(t) == inorder[t]

    def test_between_ticks_it_is_that_of_the_nearest(self, benchmark: Bicycle):
        course = ScenarioCourse(_scenario(pushes=[PUSH], period=0.01), benchmark)
        assert course.disturbance(1.104) == course.disturbance(1.1) != course.disturbance(1.11)

    def test_the_seed_is_that_of_wind_and_phases(self, benchmark: Bicycle):
        for one, of_seed in ((EACH_KIND[0], True), (EACH_KIND[2], True), (EACH_KIND[1], False)):
            first, same, other = (
                ScenarioCourse(_scenario(disturbances=[one], seed=seed), benchmark)
                for seed in (1, 1, 2)
            )
            assert first.disturbance(0.7) == same.disturbance(0.7)
            assert (first.disturbance(0.7) != other.disturbance(0.7)) == of_seed

    def test_two_of_a_kind_are_not_the_same(self, benchmark: Bicycle):
        one, two = (
            ScenarioCourse(_scenario(disturbances=[EACH_KIND[2]] * n), benchmark) for n in (1, 2)
        )
        assert two.disturbance(0.7).roll != pytest.approx(2 * one.disturbance(0.7).roll)


class TestBatch:
    def test_each_has_what_it_has_alone(self, benchmark: Bicycle):
        scenarios = [
            _scenario(
                seed=i,
                speed=3.0 + 0.1 * i,
                disturbances=EACH_KIND[: i % 5],
                pushes=[{"time": 0.3 * i, "impulse": 5.0 - i}] * (i % 3),
            )
            for i in range(8)
        ]
        together = BatchCourse(scenarios, benchmark)
        alone = [ScenarioCourse(one, benchmark) for one in scenarios]
        for k in range(0, 3 * BLOCK, 7):
            moments = together.disturbance(k * 1e-3)
            assert [course.disturbance(k * 1e-3) for course in alone] == list(
                zip(*(part.tolist() for part in moments), strict=True)
            )

    def test_different_speeds_are_the_same_array_at_all_times(self, benchmark: Bicycle):
        together = BatchCourse([_scenario(speed=v) for v in (3, 4, 5)], benchmark)
        assert together.speed(0.0).tolist() == [3, 4, 5]
        assert together.speed(7.0) is together.speed(0.0)

    def test_what_is_equal_for_all_is_a_float(self, benchmark: Bicycle):
        together = BatchCourse([_scenario(seed=i, speed=4) for i in range(3)], benchmark)
        assert together.speed(1.0) == 4.0
        assert together.disturbance(1.0) == Moments(0.0, 0.0)

    def test_a_speed_profile_is_one_for_all(self, benchmark: Bicycle):
        profile = ((0.0, 3.0), (2.0, 5.0))
        together = BatchCourse(
            [_scenario(seed=i, speed_profile=profile) for i in range(3)], benchmark
        )
        assert [together.speed(t) for t in (0.0, 1.0, 3.0)] == [3, 4, 5]
