import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from bikesim.path.building import make_path
from bikesim.path.path import REACH, Path, path_points, straight_path
from bikesim.path.settings import PATH_KINDS, PathSettings

KINDS = [kind for kind in PATH_KINDS if kind != "csv"]
LEMON = ((0, 0), (10, 0), (20, 4), (22, 12), (12, 16), (-2, 14), (-8, 6), (0, 0))


@pytest.fixture(params=[*KINDS, "closed csv"])
def path(request: pytest.FixtureRequest) -> Path:
    if request.param == "closed csv":
        return make_path(PathSettings(kind="csv", points=LEMON))
    return make_path(PathSettings(kind=request.param))


@pytest.fixture
def stations(path: Path) -> np.ndarray:
    """From before the path to beyond it; of a closed one, two laps and more."""
    return np.linspace(-7.0, 2.6 * path.length + 30.0, 1501)


class TestEachPath:
    def test_begins_at_the_origin_along_x(self, path: Path):
        assert path.point(0.0) == pytest.approx((0, 0), abs=1e-9)
        assert path.heading(0.0) == pytest.approx(0, abs=1e-9)

    def test_its_station_is_the_length_along_it(self, path: Path, stations: np.ndarray):
        x, y = path.point(np.linspace(stations[0], stations[-1], 400_001))
        length = np.hypot(np.diff(x), np.diff(y)).sum()
        assert length == pytest.approx(stations[-1] - stations[0], rel=1e-5)

    def test_its_heading_is_the_direction_it_runs_in(self, path: Path, stations: np.ndarray):
        (x0, y0), (x1, y1) = path.point(stations - 1e-4), path.point(stations + 1e-4)
        way = np.arctan2(y1 - y0, x1 - x0)
        apart = np.remainder(way - path.heading(stations) + np.pi, 2 * np.pi) - np.pi
        assert np.abs(apart).max() < 1e-5

    def test_its_heading_does_not_jump(self, path: Path, stations: np.ndarray):
        assert np.abs(np.diff(path.heading(stations))).max() < 0.51 * np.diff(stations)[0]

    def test_curvature_is_the_slope_of_the_heading(self, path: Path, stations: np.ndarray):
        slope = (path.heading(stations + 1e-4) - path.heading(stations - 1e-4)) / 2e-4
        assert np.abs(slope - path.curvature(stations)).max() < 2e-3

    def test_lateral_is_the_integral_of_the_heading(self, path: Path, stations: np.ndarray):
        fine = np.linspace(0.0, stations[-1], 400_001)
        integral = np.trapezoid(path.heading(fine), fine)
        assert path.lateral(stations[-1]) == pytest.approx(integral, rel=1e-6, abs=1e-6)
        assert path.lateral(0.0) == pytest.approx(0, abs=1e-12)

    def test_floats_and_arrays_give_the_same_bits(self, path: Path, stations: np.ndarray):
        for of in (path.heading, path.curvature, path.lateral):
            assert np.array_equal([of(s) for s in stations.tolist()], of(stations))
        points = [path.point(s) for s in stations.tolist()]
        assert np.array_equal(points, np.transpose(path.point(stations)))
        x, y, near = points_beside(path, stations)
        alone = [
            path.place(*one) for one in zip(x.tolist(), y.tolist(), near.tolist(), strict=True)
        ]
        assert np.array_equal(np.transpose(alone), path.place(x, y, near))

    def test_a_point_beside_it_is_found(self, path: Path, stations: np.ndarray):
        place = path.place(*points_beside(path, stations))
        assert np.abs(place.station - stations).max() < 1e-4
        assert np.abs(place.deviation - 0.8 * np.sin(stations)).max() < 1e-6
        assert np.abs(place.heading - path.heading(place.station)).max() < 1e-7

    def test_what_is_no_number_stays_none(self, path: Path):
        assert math.isnan(path.place(math.nan, 0.0, 0.0).deviation) or path.straight
        assert math.isnan(path.place(0.0, math.nan, math.nan).deviation)
        place = path.place(np.array([math.nan, 1.0]), np.zeros(2), np.array([0.0, 1.0]))
        assert np.isnan(place.station[0])
        assert place.station[1] == pytest.approx(1, abs=0.01)


def points_beside(path: Path, stations: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points up to 0.8 m from the path, and stations some way from theirs to seek from."""
    (x, y), heading, deviation = path.point(stations), path.heading(stations), np.sin(stations)
    near = stations + 0.1 * np.cos(3 * stations)
    return x - 0.8 * deviation * np.sin(heading), y + 0.8 * deviation * np.cos(heading), near


class TestPlace:
    @pytest.mark.parametrize("kind", ["slalom", "double-lane-change", "figure-eight"])
    def test_is_the_nearest_point(self, kind: str):
        path = make_path(PathSettings(kind=kind))
        for x, y in [(3.0, 1.0), (14.0, -0.5), (23.0, 1.8)]:
            station, deviation, _ = path.place(x, y, 0.0)
            for _ in range(40):
                station, deviation, _ = path.place(x, y, station)

            def apart(s: float, x: float = x, y: float = y) -> float:
                return math.dist(path.point(s), (x, y))

            bounds = (station - 5, station + 5)
            best = minimize_scalar(apart, bounds=bounds, method="bounded", options={"xatol": 1e-9})
            assert abs(deviation) == pytest.approx(best.fun, abs=1e-6)
            assert station == pytest.approx(best.x, abs=1e-4)

    def test_right_of_the_path_is_positive(self):
        path = make_path(PathSettings(kind="circle", start=0, side="left"))
        x, y = path.point(60.0)
        heading = path.heading(60.0)
        right = path.place(x - 0.3 * math.sin(heading), y + 0.3 * math.cos(heading), 60.0)
        assert right.deviation == pytest.approx(0.3)

    def test_at_the_crossing_the_branch_is_kept(self):
        """Ridden over the crossing of a figure of eight, along each of its two branches."""
        path = make_path(PathSettings(kind="figure-eight", start=0.0))
        for begin in (0.0, 0.5 * path.length, path.length):
            station = begin - 4.0
            for s in np.arange(begin - 4, begin + 4, 0.05):
                x, y = path.point(float(s))
                station = path.place(x + 0.3, y - 0.4, station).station
                assert abs(station - s) < 0.8

    def test_it_never_moves_farther_than_its_reach(self):
        path = make_path(PathSettings(kind="circle"))
        for x, y in [(500.0, 40.0), (20.0, 20.0), (-300.0, 1.0)]:
            assert abs(path.place(x, y, 50.0).station - 50.0) <= REACH

    def test_seen_from_one_station_for_all(self):
        path = make_path(PathSettings(kind="lane-change"))
        place = path.place(np.array([0.1, 0.2]), np.zeros(2), 0.0)
        assert place.station == pytest.approx([0.1, 0.2])


class TestStraight:
    def test_is_said(self):
        assert straight_path().straight
        assert make_path(PathSettings()).straight
        assert not make_path(PathSettings(kind="slalom")).straight

    def test_station_and_deviation_are_x_and_y_however_far(self):
        assert straight_path().place(1e4, -3.0, 0.0) == (1e4, -3.0, 0.0)
        many = straight_path().place(np.array([5.0, 9.0]), np.array([1.0, 2.0]), 0.0)
        assert [part.tolist() for part in many] == [[5, 9], [1, 2], [0, 0]]

    def test_it_is_the_x_axis(self):
        path = straight_path()
        assert path.point(-12.5) == (-12.5, 0)
        assert (path.heading(7.0), path.curvature(7.0), path.lateral(7.0)) == (0, 0, 0)


class TestPoints:
    def test_are_on_the_path_and_no_farther_apart_than_asked(self):
        path = make_path(PathSettings(kind="slalom"))
        points = path_points(path, 5.0, 77.1, apart=0.5)
        assert points[0] == pytest.approx(path.point(5.0))
        assert points[-1] == pytest.approx(path.point(77.1))
        gaps = np.hypot(*np.diff(points, axis=0).T)
        assert gaps.max() <= 0.5
        assert len(points) == 146
