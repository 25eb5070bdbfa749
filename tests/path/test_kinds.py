"""The paths against their formulas."""

import math

import numpy as np
import pytest

from bikesim.path.building import make_path
from bikesim.path.path import Path
from bikesim.path.settings import PathSettings


def _path(kind: str, **figures) -> Path:
    return make_path(PathSettings(kind=kind, **figures))


def _at_x(path: Path, x: np.ndarray) -> np.ndarray:
    """y of a path that goes ever forward."""
    fine = np.linspace(0.0, path.length, 20_001)
    xs, ys = path.point(fine)
    return np.interp(x, xs, ys)


class TestLaneChange:
    def test_the_jerk_is_the_least(self):
        """[Flash & Hogan 1985, eq. 7]"""
        path = _path("lane-change", start=5, offset=-1.5, length=12)
        x = np.linspace(0, 30, 301)
        u = np.clip((x - 5) / 12, 0, 1)
        expected = -1.5 * (10 * u**3 - 15 * u**4 + 6 * u**5)
        assert _at_x(path, x) == pytest.approx(expected, abs=1e-5)

    def test_beyond_it_goes_on_in_the_other_lane(self):
        path = _path("lane-change")
        x, y = path.point(1000.0)
        assert (y, path.heading(1000.0)) == pytest.approx((2.0, 0.0), abs=1e-9)
        assert x == pytest.approx(1000.0, abs=0.3)

    def test_back(self):
        path = _path("lane-change", back=True, start=10, length=15, hold=8)
        x = np.array([10.0, 17.5, 25.0, 33.0, 40.5, 48.0, 60.0])
        assert _at_x(path, x) == pytest.approx([0, 1, 2, 2, 1, 0, 0], abs=1e-6)

    def test_double_has_the_proportions_of_the_standard(self):
        """ISO 3888-2: straight 12 m, change 13.5 m, 11 m in the other lane, 12.5 m back."""
        x = np.array([12, 12 + 13.5 / 2, 25.5, 36.5, 36.5 + 12.5 / 2, 49.0, 61.0])
        assert _at_x(_path("double-lane-change"), x) == pytest.approx(
            [0, 1, 2, 2, 1, 0, 0], abs=1e-6
        )


class TestSlalom:
    @pytest.mark.parametrize("count", [1, 2, 5])
    def test_its_bends_are_half_a_wavelength_apart_on_alternate_sides(self, count: int):
        path = _path("slalom", start=7, amplitude=0.8, wavelength=20, count=count)
        peaks = 17 + 10 * np.arange(count)
        sides = 0.8 * (-1.0) ** np.arange(count)
        assert _at_x(path, peaks) == pytest.approx(sides, abs=1e-5)
        assert _at_x(path, np.array([0.0, 7, 17 + 10 * count, 20 + 10 * count])) == pytest.approx(
            [0] * 4, abs=1e-5
        )

    def test_between_them_it_is_a_cosine(self):
        path = _path("slalom", start=0, amplitude=1.2, wavelength=30, count=4)
        x = np.linspace(15, 60, 91)
        expected = 1.2 * np.cos(2 * np.pi * (x - 15) / 30)
        assert _at_x(path, x) == pytest.approx(expected, abs=1e-5)


class TestCircle:
    @pytest.mark.parametrize(("side", "sign"), [("right", 1), ("left", -1)])
    def test_every_point_has_its_distance_from_the_centre(self, side: str, sign: int):
        path = _path("circle", radius=15, side=side, start=4, entry=8)
        x, y = path.point(np.linspace(12, 12 + 3 * 2 * np.pi * 15, 500))
        # The centre lies a radius beside the begin of the circle.
        heading = path.heading(12.0)
        x0, y0 = path.point(12.0)
        centre = x0 - sign * 15 * math.sin(heading), y0 + sign * 15 * math.cos(heading)
        assert np.hypot(x - centre[0], y - centre[1]) == pytest.approx(15, abs=1e-6)
        assert sign * y.mean() > 0

    def test_a_lap_turns_once(self):
        path = _path("circle", side="left")
        lap = 2 * math.pi * 20
        assert path.heading(40 + 3 * lap) - path.heading(40.0) == pytest.approx(-6 * math.pi)
        assert path.point(40 + 3 * lap) == pytest.approx(path.point(40.0), abs=1e-6)

    def test_its_curvature_sets_in_smoothly(self):
        path = _path("circle", radius=10, start=5, entry=10)
        assert path.curvature(np.array([4.9, 10, 15, 80])) == pytest.approx([0, 0.05, 0.1, 0.1])
        assert path.heading(15.0) == pytest.approx(0.5 * 10 / 10)

    def test_the_distance_to_it_is_the_deviation(self):
        path = _path("circle", radius=10, start=0, entry=5)
        x0, y0 = path.point(5.0)
        heading = path.heading(5.0)
        centre = x0 - 10 * math.sin(heading), y0 + 10 * math.cos(heading)
        x, y = path.point(20.0)
        outward = 1.07 * (x - centre[0]) + centre[0], 1.07 * (y - centre[1]) + centre[1]
        place = path.place(*outward, 20.1)
        assert (place.station, place.deviation) == pytest.approx((20, -0.7), abs=1e-6)


class TestFigureEight:
    def test_is_bernoullis_lemniscate(self):
        """(X² + Y²)² = a² (X² - Y²) along its axis, with a three times the smallest radius."""
        path = _path("figure-eight", radius=8, start=0)
        x, y = path.point(np.linspace(0, path.length, 700))
        X, Y = (x + y) / math.sqrt(2), (y - x) / math.sqrt(2)
        assert np.abs((X**2 + Y**2) ** 2 - 24**2 * (X**2 - Y**2)).max() < 1e-2
        assert np.ptp(X) == pytest.approx(48, rel=1e-4)

    def test_its_length_is_that_of_gauss(self):
        """The lemniscate constant ϖ = 2.62205755429212, twice for a half-width of 1."""
        assert _path("figure-eight", radius=8, start=0).length == pytest.approx(
            2 * 2.62205755429212 * 24, rel=1e-8
        )

    def test_curvature_grows_with_the_distance_from_the_crossing(self):
        path = _path("figure-eight", radius=8, start=0)
        s = np.linspace(0, path.length, 200)
        assert np.abs(path.curvature(s)) == pytest.approx(
            3 * np.hypot(*path.point(s)) / 24**2, abs=1e-5
        )
        assert np.abs(path.curvature(s)).max() == pytest.approx(1 / 8, rel=1e-3)

    @pytest.mark.parametrize(("side", "sign"), [("right", 1), ("left", -1)])
    def test_turns_to_the_given_side_and_then_to_the_other(self, side: str, sign: int):
        path = _path("figure-eight", side=side, start=0)
        first, second = path.curvature(np.array([0.25, 0.75]) * path.length)
        assert first * sign > 0 > second * sign
        assert path.heading(path.length) == pytest.approx(0, abs=1e-9)

    def test_comes_back_to_its_crossing_after_a_run_up(self):
        path = _path("figure-eight", start=6)
        assert path.point(6 + 2 * 10 * 3 * 2.62205755429212) == pytest.approx((6, 0), abs=1e-5)
        assert path.loop == pytest.approx(6, abs=1e-9)
