"""Poses between ticks."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.view.pose import Pose, PoseTrack


class Ridden:
    """As much of a run as a track reads: a straight ride at 2 m/s, 100 ticks a second."""

    path = Path("run.h5")

    def __init__(self, ticks: int = 101, **channels: Any) -> None:
        time = np.arange(ticks) / 100
        values = dict.fromkeys(Pose._fields, np.zeros(ticks))
        self.values = {**values, "time": time, "x": 2 * time, "distance": 2 * time, **channels}
        self.names = tuple(self.values)

    def channel(self, name: str) -> np.ndarray:
        return self.values[name]


def track(*ticks: int, **channels: Any) -> PoseTrack:
    return PoseTrack(Ridden(*ticks, **channels))  # pyright: ignore[reportArgumentType]


def test_begins_and_ends_with_the_ticks():
    assert (track().first, track().last) == (0.0, 1.0)


def test_is_linear_between_ticks():
    assert track().at(0.505).x == pytest.approx(1.01, abs=1e-12)


def test_stays_where_it_was_after_the_end():
    assert track().at(7.0) == track().at(1.0)


def test_heading_goes_on_where_the_recorded_one_jumps():
    heading = np.angle(np.exp(1j * np.linspace(3, 4, 101)))
    assert track(heading=heading).at(0.995).heading == pytest.approx(3.995, abs=1e-9)


def test_a_heading_that_jumps_does_not_turn_back_between_two_ticks():
    heading = np.array([math.pi - 0.1, -math.pi + 0.1])
    assert track(2, heading=heading).at(0.005).heading == pytest.approx(math.pi, abs=1e-9)


def test_sampled_gives_the_same_as_one_by_one():
    times = np.array([0.0, 0.123, 1.0])
    np.testing.assert_array_equal(track().sampled(times), [track().at(t) for t in times])


def test_what_comes_after_a_value_that_is_not_finite_is_left_out():
    roll = np.zeros(101)
    roll[60] = math.nan
    assert track(roll=roll).last == 0.59


def test_a_record_without_ticks_is_refused():
    with pytest.raises(InputError, match=r"run\.h5: no ticks are recorded"):
        track(0)


def test_a_record_without_a_channel_is_refused():
    run = Ridden()
    run.names = tuple(name for name in run.names if name != "heading")
    with pytest.raises(InputError, match=r"run\.h5: channel heading is missing"):
        PoseTrack(run)  # pyright: ignore[reportArgumentType]
