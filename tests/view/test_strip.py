"""The strip of signals: what is lit, and where."""

import numpy as np
import pytest

from bikesim.record.reader import Run
from bikesim.view.drawing import ORANGE, SKY, VERMILION
from bikesim.view.pose import Pose, PoseTrack
from bikesim.view.reel import Curves, Moment, Reel, make_reel
from bikesim.view.strip import Limits, Strip, limits, nice

WIDTH, HEIGHT = 600, 100


def curves(duration: float) -> Curves:
    """Roll 4, steer -4 deg; feedback 1, rider -1 N m."""
    time = np.linspace(0, duration, 2000)
    one = np.ones_like(time)
    return Curves(time, 4 * one, -4 * one, one, -one)


def drawn(time: float, duration: float = 10.0, window: float = 10.0) -> np.ndarray:
    pose = Pose(time, 3, np.radians(4), np.radians(-4), 0, 0, 0, 0)
    frame = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    strip = Strip(curves(duration), Limits(5, 2, window), WIDTH, HEIGHT, unit=0.5)
    strip.draw(frame, Moment(pose, 1.0, -1.0))
    return frame


def lit(frame: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Columns and rows of the pixels of a colour in the plots, leaving out the names above."""
    near = np.abs(frame.astype(int) - colour).max(axis=2) < 25
    near[:17] = False
    return np.argwhere(near)[:, ::-1]


def test_a_curve_grows_with_time():
    ends = [lit(drawn(time), SKY)[:, 0].max() for time in (2.0, 5.0, 10.0)]
    width = WIDTH // 2 - round(58 * 0.5) - round(26 * 0.5)
    assert np.diff(ends).tolist() == pytest.approx([0.3 * width, 0.5 * width], abs=2)


def test_positive_is_above_negative():
    frame = drawn(5.0)
    assert lit(frame, SKY)[:, 1].max() < lit(frame, VERMILION)[:, 1].min()


def test_angles_are_left_and_torques_right():
    frame = drawn(5.0)
    assert lit(frame, SKY)[:, 0].max() < WIDTH / 2 < lit(frame, ORANGE)[:, 0].min()


def test_a_long_run_shows_its_last_seconds():
    full = lit(drawn(10.0), SKY)[:, 0]
    scrolled = lit(drawn(471.3, duration=600.0), SKY)[:, 0]
    assert (scrolled.min(), scrolled.max()) == pytest.approx((full.min(), full.max()), abs=2)


def test_the_same_frame_is_the_same_whatever_was_drawn_before():
    strip = Strip(curves(100.0), Limits(5, 2, 10.0), WIDTH, HEIGHT, unit=0.5)
    frame, moments = np.empty((HEIGHT, WIDTH, 3), np.uint8), []
    for time in (95.0, 3.0, 40.0, 95.0):
        strip.draw(frame, Moment(Pose(time, 3, 0, 0, 0, 0, 0, 0), 1.0, -1.0))
        moments.append(frame.copy())
    np.testing.assert_array_equal(moments[0], moments[-1])


def reel(run: Run) -> Reel:
    track = PoseTrack(run)
    return make_reel(run, track, np.array([0.0, track.last]))


def test_the_axes_hold_the_whole_of_a_run(upright: Run):
    axes = limits([reel(upright)])
    assert axes.angle >= np.degrees(np.abs(upright.channel("roll")).max())
    assert axes.torque >= np.abs(upright.channel("sent_torque")).max()


def test_a_rig_without_a_rider_model_has_a_strip_too(upright: Run):
    curves_ = reel(upright).curves._replace(rider=np.empty(0))
    frame = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    strip = Strip(curves_, Limits(5, 2, 10.0), WIDTH, HEIGHT, unit=0.5)
    strip.draw(frame, Moment(Pose(0.5, 3, 0, 0, 0, 0, 0, 0), 1.0, np.nan))
    assert len(lit(frame, ORANGE)) == 0


@pytest.mark.parametrize(("value", "round_one"), [(0.13, 0.15), (5.6, 6), (10, 10), (41, 50)])
def test_ends_of_axes_are_round(value: float, round_one: float):
    assert nice(value) == pytest.approx(round_one)
