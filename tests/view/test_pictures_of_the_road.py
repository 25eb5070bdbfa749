"""What can be measured in pictures of the road scene: horizon, period, ribbon, what is in sight."""

import importlib.util
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim.view.pose import Pose

NOWHERE = Pose(0, 5, 0, 0, 0, 0, 0, 0)
LAND = ("ground", "road", "road markings")
ROLLS = (-30, -12, 0, 8, 25)


VIEWS = ("first", "second")
WINDING = np.stack([WAY := np.arange(-20.0, 400.0, 0.5), 2.0 * np.sin(WAY / 12)], 1)
HORIZONS = [("first", True, roll) for roll in ROLLS] + [("first", False, 25), ("second", True, 25)]
PLACES = [(view, x) for view in VIEWS for x in (37.3, 757.3, 10117.3, 41.0)]
FIVE = ["benchmark", "browser", "davis", "pista", "rigid"]


@pytest.fixture(scope="module")
def album() -> dict[Any, Any]:
    """All pictures of these tests, drawn by one process: see tests/view/draw.py."""
    spec = importlib.util.spec_from_file_location("draw", Path(__file__).with_name("draw.py"))
    assert spec is not None
    assert spec.loader is not None
    draw = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw)

    def shot(view: str, pose: Pose = NOWHERE, **how: Any) -> Any:
        return draw.Shot(pose, view, **how)

    shots: dict[Any, Any] = {("beside",): shot("first", NOWHERE._replace(y=1.0))}
    for view, cue, roll in HORIZONS:
        pose = NOWHERE._replace(roll=math.radians(roll), steer=0.1, x=7.0)
        shots["horizon", view, cue, roll] = shot(view, pose, roll_cue=cue, segments=True)
    for view, x in PLACES:
        shots["place", view, x] = shot(view, NOWHERE._replace(x=x, y=0.4, roll=0.1, heading=0.05))
    for view in VIEWS:
        shots["winding", view] = shot(view, NOWHERE._replace(x=30.0, y=2.3), path=WINDING)
        leaning = NOWHERE._replace(roll=0.2, steer=0.1)
        shots["things", view] = shot(view, leaning, segments=True)
        for bicycle in FIVE:
            shots["bicycle", view, bicycle] = shot(view, leaning, bicycle=bicycle)
    return dict(zip(shots, draw.pictures(list(shots.values())), strict=True))


def edge_of_the_land(picture: Any) -> np.ndarray:
    """Where land lies directly under sky: what stands on the land is left out."""
    land, sky = picture.seen(*LAND), picture.pixels == -1
    rows, columns = np.nonzero(sky[:-1] & land[1:])
    return np.stack([columns, rows + 0.5], 1)


def slope_to_the_right(edge: np.ndarray) -> float:
    """The angle of the edge [deg], rising to the right positive."""
    slope, _ = np.polyfit(edge[:, 0], edge[:, 1], 1)
    return -math.degrees(math.atan(slope))


@pytest.mark.parametrize("roll", ROLLS)
def test_the_horizon_of_the_rider_has_the_recorded_roll(album: dict[Any, Any], roll: int):
    edge = edge_of_the_land(album["horizon", "first", True, roll])
    assert len(edge) > 100
    assert slope_to_the_right(edge) == pytest.approx(roll, abs=0.2)


@pytest.mark.parametrize(("view", "cue"), [("first", False), ("second", True)])
def test_the_horizon_is_level_without_the_roll_cue_and_from_behind(
    album: dict[Any, Any], view: str, cue: bool
):
    edge = edge_of_the_land(album["horizon", view, cue, 25])
    assert slope_to_the_right(edge) == pytest.approx(0, abs=0.1)


def test_the_riders_horizon_is_about_a_third_from_the_top(album: dict[Any, Any]):
    edge = edge_of_the_land(album["horizon", "first", True, 0])
    assert 0.27 < np.median(edge[:, 1]) / 360 < 0.40


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("x", [757.3, 10117.3])
def test_whole_periods_on_it_looks_the_same_in_every_pixel(
    album: dict[Any, Any], view: str, x: float
):
    here, there = (album["place", view, at].pixels for at in (37.3, x))
    np.testing.assert_array_equal(here, there)


@pytest.mark.parametrize("view", VIEWS)
def test_elsewhere_it_looks_different(album: dict[Any, Any], view: str):
    here, there = (album["place", view, at].pixels for at in (37.3, 41.0))
    assert (here != there).mean() > 0.05


def is_ribbon(pixels: np.ndarray) -> np.ndarray:
    red, green, blue = (pixels[..., k].astype(int) for k in range(3))
    return (red > 170) & (green > 120) & (blue < 0.45 * red)


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("ahead", [11.0, 16.0, 22.0])
def test_the_ribbon_is_where_the_path_is(album: dict[Any, Any], view: str, ahead: float):
    picture = album["winding", view]
    x, y = WINDING[np.argmin(np.abs(WINDING[:, 0] - 30.0 - ahead))]
    column, row = picture.pixel(np.array([x - 30.0, -(y - 2.3), 0.0]))
    lit = np.flatnonzero(is_ribbon(picture.pixels[round(row)]))
    assert len(lit) > 0
    assert np.abs(lit - column).min() < 2.5


def test_the_straight_path_of_a_rider_beside_it_is_to_the_left(album: dict[Any, Any]):
    picture = album["beside",]
    columns = np.nonzero(is_ribbon(picture.pixels[180:280]))[1]
    column, _ = picture.pixel(np.array([5.0, 1.0, 0.0]))
    assert column < 320
    assert np.abs(columns - column).min() < 3


@pytest.mark.parametrize("thing", ["bar", "hand left", "hand right", "forearm left"])
def test_the_rider_sees_bar_and_hands_at_the_bottom(album: dict[Any, Any], thing: str):
    rows = np.nonzero(album["things", "first"].seen(thing))[0]
    assert len(rows) > 50
    assert rows.min() > 0.6 * 360


def test_the_rider_does_not_see_his_own_head_and_trunk(album: dict[Any, Any]):
    own = ("head", "trunk", "upper arm left", "upper arm right")
    assert not album["things", "first"].seen(*own).any()


@pytest.mark.parametrize("thing", ["head", "trunk", "rear tyre", "shoe left", "front tyre"])
def test_from_behind_all_of_the_rider_is_in_the_picture(album: dict[Any, Any], thing: str):
    rows, columns = np.nonzero(album["things", "second"].seen(thing))
    assert len(rows) > 5
    assert rows.min() > 0
    assert rows.max() < 359
    assert columns.min() > 120
    assert columns.max() < 520


def test_from_behind_the_road_ahead_is_in_sight(album: dict[Any, Any]):
    rows = np.nonzero(album["things", "second"].seen("road", "road markings"))[0]
    assert rows.min() < 0.35 * 360


@pytest.mark.parametrize("bicycle", FIVE)
@pytest.mark.parametrize("view", VIEWS)
def test_no_part_of_a_picture_is_black(album: dict[Any, Any], view: str, bicycle: str):
    brightest = album["bicycle", view, bicycle].pixels.max(axis=-1)
    assert (brightest < 12).mean() < 0.001
