from pathlib import Path as FilePath

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.path.building import make_path
from bikesim.path.csv_file import read_points
from bikesim.path.path import Path
from bikesim.path.settings import PathSettings


@pytest.fixture
def write(tmp_path: FilePath):
    def written(text: str) -> FilePath:
        (tmp_path / "track.csv").write_text(text)
        return tmp_path / "track.csv"

    return written


def _along(points) -> Path:
    return make_path(PathSettings(kind="csv", points=points))


def _refused(points) -> str:
    with pytest.raises(InputError) as refused:
        _along(points)
    assert "\n" not in str(refused.value)
    return str(refused.value)


class TestReading:
    @pytest.mark.parametrize(
        "text",
        [
            "0,0\n5,1\n9,2\n",
            "x,y\n0,0\n5,1\n9,2",
            "x [m]; y [m]\n0; 0\n5; 1\n9; 2\n",
            "time\ty_m\tx_m\n0\t0\t0\n1\t1\t5\n2\t2\t9\n",
            "# a track\n\n0 0\n  5.0   1.0\n9e0 2\n",
            '"x","y"\r\n0,0\r\n5,1\r\n9,2\r\n',
        ],
    )
    def test_columns(self, write, text: str):
        assert read_points(write(text)) == ((0, 0), (5, 1), (9, 2))

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            ("0,0\n5,left\n", "line 2: 'left' must be a number"),
            ("0,0\n5,nan\n", "line 2: 'nan' must be a number"),
            ("x,y\n0,0\n5\n", "line 3: 1 columns, x and y"),
            ("0,0\n,\n", "line 2: '' must be a number"),
        ],
    )
    def test_what_is_wrong_is_told_with_its_line(self, write, text: str, told: str):
        file = write(text)
        with pytest.raises(InputError) as refused:
            read_points(file)
        assert str(refused.value).startswith(f"path.file {file}: {told}")

    def test_no_file(self, tmp_path: FilePath):
        with pytest.raises(InputError, match=r"path\.file .*nowhere\.csv: no such file"):
            PathSettings(kind="csv", file=str(tmp_path / "nowhere.csv"))


class TestCurve:
    POINTS = ((0, 0), (4, 0), (9, 1), (15, 1.2), (20, 0))

    def test_goes_through_its_points(self):
        x, y = _along(self.POINTS).point(np.linspace(0, 25, 25_001))
        for point in self.POINTS:
            assert np.hypot(x - point[0], y - point[1]).min() < 1e-3

    def test_elsewhere_and_turned_it_is_the_same(self):
        turned = [(7 - y, -3 + x) for x, y in self.POINTS]
        s = np.linspace(0, 30, 61)
        assert np.allclose(_along(turned).point(s), _along(self.POINTS).point(s), atol=1e-9)

    def test_points_of_a_circle_give_one_that_is_closed(self):
        around = np.linspace(0, 2 * np.pi, 61)
        points = tuple(zip(100 + 12 * np.sin(around), 7 - 12 * np.cos(around), strict=True))
        path = _along((*points[:-1], points[0]))
        assert path.closed
        assert path.length == pytest.approx(2 * np.pi * 12, rel=1e-5)
        s = np.linspace(0, 3 * path.length, 100)
        x, y = path.point(s)
        assert np.hypot(x, y - 12) == pytest.approx(12, abs=1e-3)
        assert path.curvature(s) == pytest.approx(1 / 12, rel=0.01)

    def test_one_that_ends_goes_on_straight(self):
        path = _along(((0, 0), (4, 0.1), (9, 1), (15, 2.2)))
        beyond = path.length + 30.0
        x0, y0 = path.point(path.length)
        x, y = path.point(beyond)
        assert np.arctan2(y - y0, x - x0) == pytest.approx(path.heading(beyond))

    def test_a_point_said_twice_is_one(self):
        assert _along(((0, 0), (4, 0), (4, 0), (9, 1), (15, 1))).length == (
            _along(((0, 0), (4, 0), (9, 1), (15, 1))).length
        )


class TestRefused:
    def test_too_few(self):
        assert _refused(((0, 0), (5, 0), (5, 0), (9, 0))).startswith("path: 3 different points")

    def test_a_jump(self):
        points = tuple((0.5 * i + (30 if i > 40 else 0), 0.0) for i in range(80))
        assert _refused(points).startswith("path: jumps by 30.5 m from point 41 to the next")

    def test_doubling_back(self):
        told = _refused(((0, 0), (3, 0), (6, 0), (9, 0), (6, 0.1), (3, 0)))
        assert told.startswith("path: turns back at point 4, by 178 deg")

    def test_too_short(self):
        assert _refused(((0, 0), (1, 0), (2, 0), (3, 0))).startswith("path: 3 m long")

    def test_too_sharp(self):
        assert "bends with a radius of" in _refused(((0, 0), (5, 0), (10, 0), (10, 5), (10, 10)))

    def test_one_that_crawls_over_itself_is_not_drawn_forever(self):
        assert "20 km" in _refused(tuple((5.0 * i, 0.0) for i in range(4900)))
