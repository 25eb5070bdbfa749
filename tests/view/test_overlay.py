"""What is lit over a grey picture, and where."""

from dataclasses import replace

import numpy as np
import pytest

from bikesim.record.reader import Run
from bikesim.view.canvas import RgbCanvas
from bikesim.view.drawing import ORANGE, SKY, VERMILION
from bikesim.view.layout import Box
from bikesim.view.overlay import Overlay
from bikesim.view.pose import PoseTrack
from bikesim.view.reel import Reel, make_reel

WIDTH, HEIGHT, GREY = 640, 360, 128


def reel(run: Run) -> Reel:
    track = PoseTrack(run)
    return make_reel(run, track, np.array([0.0, track.last - track.first]))


def drawn(
    reel: Reel, *, roll: float = 0.0, torque: float = 0.0, time: float = 0.0, lean: bool = True
) -> np.ndarray:
    canvas = RgbCanvas(WIDTH, HEIGHT)
    canvas.pixels[:] = GREY
    moment = reel.moment(0)
    pose = moment.pose._replace(roll=np.radians(roll))
    overlay = Overlay(reel, Box(0, 0, WIDTH, HEIGHT), 0.5, lean=lean, torque_scale=2.0)
    overlay.draw(canvas, moment._replace(pose=pose, feedback=torque), time)
    return canvas.pixels


def columns(area: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return np.argwhere(np.abs(area.astype(int) - colour).max(axis=2) < 25)[:, 1]


def touched(area: np.ndarray) -> np.ndarray:
    return (area != GREY).any(axis=2)


def test_time_and_haptics_stand_in_the_upper_corners(upright: Run):
    marks = touched(drawn(reel(upright)))
    assert marks[:50, :80].any()
    assert marks[:40, -160:].any()
    assert not marks[80:200].any()


@pytest.mark.parametrize("roll", [-20.0, 20.0])
def test_the_needle_leans_as_the_bicycle_does(upright: Run, roll: float):
    straight = columns(drawn(reel(upright)), SKY).mean()
    leaning = columns(drawn(reel(upright), roll=roll), SKY).mean()
    assert np.sign(leaning - straight) == np.sign(roll)


def test_without_a_roll_cue_there_is_no_dial(upright: Run):
    assert not touched(drawn(reel(upright), lean=False))[200:, : WIDTH // 2].any()


def test_the_bar_is_as_long_as_the_torque(upright: Run):
    one, two = (len(columns(drawn(reel(upright), torque=t), ORANGE)) for t in (0.5, 1.0))
    assert two / one == pytest.approx(2, rel=0.1)


def test_the_bar_goes_to_the_side_of_the_torque(upright: Run):
    left, right = (columns(drawn(reel(upright), torque=t), ORANGE) for t in (-1.0, 1.0))
    assert left.max() <= right.min()


def test_a_torque_at_the_limit_is_red(upright: Run):
    limited = replace(reel(upright), torque_limit=1.5)
    assert len(columns(drawn(limited, torque=1.5), ORANGE)) == 0
    assert len(columns(drawn(limited, torque=1.5), VERMILION)) > 400


def test_the_limit_is_the_smaller_one_of_the_scenario(upright: Run):
    scenario = "[guard]\ntorque_limit = 10.0\n[rig]\ntorque_limit = 3.5"
    assert reel(upright).torque_limit == 10.0
    assert reel(replace(upright, scenario=scenario)).torque_limit == 3.5
    assert reel(replace(upright, scenario="not TOML")).torque_limit is None


def test_a_fall_is_written_large_from_when_it_happened(fallen: Run):
    film = reel(fallen)
    assert film.end_text == f"fell at {film.last:.1f} s"
    before, after = (drawn(film, time=time) for time in (film.last - 0.01, film.last))
    assert not touched(before)[110:140, 310:330].any()
    assert touched(after)[110:140, 310:330].all()


def test_a_record_that_was_cut_short_says_so(upright: Run):
    cut = reel(replace(upright, complete=False, ending=None))
    assert cut.end_text == "record cut short at 1.0 s"


def test_haptics_off_is_said(upright: Run, fallen: Run):
    assert (reel(upright).haptics, reel(fallen).haptics) == ("haptics on, law paper", "haptics off")
