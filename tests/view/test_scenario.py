"""What pictures take from the scenario of a record: the path, the roll cue, the limit."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.record.reader import Run
from bikesim.view.crew import Crew
from bikesim.view.gl import Backend
from bikesim.view.quality import Quality
from bikesim.view.scenario import Shown
from bikesim.view.video import Look, make_film

LANE_CHANGE = '[path]\nkind = "lane-change"\nstart = 5.0\nlength = 10.0\noffset = -3.0\n'
WIDTH, HEIGHT = 640, 360


def shown(run: Run, scenario: str) -> Shown:
    return Shown(replace(run, scenario=scenario))


def from_behind(ahead: float, right: float) -> tuple[float, float]:
    """Column and row of a point on the ground, by the camera `second` of mjcf/world.xml."""
    x, z = ahead + 3.45, -2.20
    depth, up = 0.9766 * x - 0.215 * z, 0.215 * x + 0.9766 * z
    scale = 0.5 * HEIGHT / math.tan(math.radians(23)) / depth
    return 0.5 * WIDTH + scale * right, 0.5 * HEIGHT - scale * up


def is_ribbon(pixels: np.ndarray) -> np.ndarray:
    red, green, blue = (pixels[..., k].astype(int) for k in range(3))
    return (red > 170) & (green > 120) & (blue < 0.45 * red)


def test_the_path_of_the_scenario_lies_on_the_road(upright: Run, backend: Backend):
    run = replace(upright, scenario=LANE_CHANGE)
    look = Look("second", WIDTH, HEIGHT, Quality.GOOD, overlay=False)
    film, _ = make_film([run], look, backend, fps=Fraction(1), speed=1.0)
    with Crew(film, [0], "rgb24", backend) as crew:
        picture = next(crew.frames()).copy()
    # Half way the lane change is half over, whatever its shape, at its end it is 3 m to the left.
    for ahead, right in ((10.0, -1.5), (15.0, -3.0), (25.0, -3.0)):
        column, row = from_behind(ahead, right)
        lit = np.flatnonzero(is_ribbon(picture[round(row)]))
        assert np.abs(lit - column).min() < 2
        assert np.ptp(lit) < 0.10 * WIDTH  # there is no other one


def test_the_path_goes_on_in_sight_of_a_ride_beyond_its_end(upright: Run):
    path = shown(upright, LANE_CHANGE).path(1000.0)
    assert path is not None
    assert path[0, 0] < -300
    assert path[-1].tolist() == pytest.approx([1400, -3], abs=1)


def test_a_closed_path_is_one_round(upright: Run):
    path = shown(upright, '[path]\nkind = "circle"\nradius = 20.0\nstart = 0.0').path(5000.0)
    assert path is not None
    assert path[:, 0].max() < 60
    assert path[:, 1].max() == pytest.approx(40, abs=1)


@pytest.mark.parametrize("scenario", ["", '[path]\nkind = "straight"', "not TOML", "path = 3"])
def test_the_straight_path_is_the_road_s_own(upright: Run, scenario: str):
    assert shown(upright, scenario).path(100.0) is None


def test_a_path_that_is_none_is_refused_with_the_record_s_name(upright: Run):
    with pytest.raises(InputError, match=r"run\.h5: its scenario: .*kind"):
        shown(upright, '[path]\nkind = "spiral"').path(1.0)


@pytest.mark.parametrize(
    ("asked", "recorded", "seen"),
    [(None, True, True), (None, False, False), (True, False, True), (False, True, False)],
)
def test_the_lean_is_seen_as_the_rider_saw_it_unless_asked_otherwise(
    upright: Run, backend: Backend, asked: bool | None, recorded: bool, seen: bool
):
    run = replace(upright, scenario=f"[vision]\nroll_cue = {str(recorded).lower()}")
    film, _ = make_film([run], Look(roll_cue=asked), backend, fps=Fraction(1), speed=1.0)
    assert film.reels[0].roll_cue is seen
