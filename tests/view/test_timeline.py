"""Which moment each frame shows."""

from fractions import Fraction

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.view.timeline import CLOCK, Timeline, frames_a_second


def test_frame_k_shows_the_run_at_k_over_fps():
    elapsed = Timeline(2.0, Fraction(30)).elapsed()
    np.testing.assert_allclose(elapsed, np.arange(61) / 30, atol=1e-12)


def test_slow_motion_has_more_frames():
    elapsed = Timeline(2.0, Fraction(30), speed=0.25).elapsed()
    assert len(elapsed) == 241
    assert elapsed[1] == pytest.approx(0.25 / 30)


def test_an_end_between_two_frames_is_a_frame_of_its_own():
    line = Timeline(0.999, Fraction(10), margin=0.0005)
    assert line.elapsed().tolist() == pytest.approx([*np.arange(10) / 10, 0.999])
    assert line.ticks()[-1] == 0.999 * CLOCK


def test_an_end_within_half_a_tick_of_a_frame_is_that_frame():
    elapsed = Timeline(1.0004, Fraction(10), margin=0.0005).elapsed()
    assert (len(elapsed), elapsed[-1]) == (11, 1.0004)


def test_a_run_of_one_tick_is_one_frame():
    assert Timeline(0.0, Fraction(30)).elapsed().tolist() == [0.0]


def test_an_end_that_is_held_is_shown_again_and_again_at_the_same_rate():
    line = Timeline(0.95, Fraction(10), hold=0.3)
    assert line.elapsed()[-4:].tolist() == [0.95] * 4
    assert np.diff(line.ticks())[-4:].tolist() == pytest.approx([4500, 9000, 9000, 9000])
    assert len(line.ticks()) == len(line.elapsed()) == 11 + 3


def test_frames_are_shown_at_rising_times():
    ticks = Timeline(10.0, frames_a_second(29.97), speed=3.3).ticks()
    assert (np.diff(ticks) > 0).all()


def test_the_frame_rates_of_television_are_exact():
    assert frames_a_second(29.97) == Fraction(30000, 1001)
    assert frames_a_second(12.5) == Fraction(25, 2)


@pytest.mark.parametrize(
    ("fps", "speed", "message"),
    [(0.5, 1, "--fps 0.5: from 1 to 240"), (30, 0, "--speed 0: from"), (240, 0.001, "more than")],
)
def test_what_no_video_can_have_is_refused(fps: float, speed: float, message: str):
    with pytest.raises(InputError, match=message):
        Timeline(3600.0, Fraction(fps), speed)
