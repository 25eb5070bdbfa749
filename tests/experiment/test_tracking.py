import numpy as np
import pytest

from bikesim.experiment.tracking import deviations
from bikesim.path.building import make_path
from bikesim.path.settings import PathSettings


def beside(path, made_up, deviation, seconds: float, speed: float = 5.0):
    """A ride along a path's own points, moved to the right by a deviation."""

    def at(time: np.ndarray):
        station = speed * time
        x, y = path.point(station)
        heading = path.heading(station)
        return x - deviation(time) * np.sin(heading), y + deviation(time) * np.cos(heading)

    return made_up(seconds, x=lambda time: at(time)[0], y=lambda time: at(time)[1], speed=speed)


def test_on_the_straight_line_it_is_y(made_up):
    history = made_up(5, x=lambda t: 5 * t, y=lambda t: 0.1 * t, speed=5)
    path = make_path(PathSettings())
    assert np.array_equal(deviations(history, path), history.y)


@pytest.mark.parametrize("speed", [0.5, 5.0, 12.0])
@pytest.mark.parametrize("kind", ["circle", "figure-eight", "double-lane-change", "slalom"])
def test_the_deviation_that_was_put_in(kind: str, speed: float, made_up):
    """Over several laps of the closed ones, crossings and all."""
    path = make_path(PathSettings(kind=kind))

    def put_in(time: np.ndarray) -> np.ndarray:
        return 0.3 + 0.2 * np.sin(0.7 * time)

    history = beside(path, made_up, put_in, seconds=90, speed=speed)
    assert deviations(history, path) == pytest.approx(put_in(history.time), abs=1e-6)


def test_who_turns_back_is_followed(made_up):
    path = make_path(PathSettings(kind="figure-eight"))

    def at(time: np.ndarray):
        station = 60.0 * np.sin(0.1 * time)
        return path.point(station), path.heading(station)

    history = made_up(
        40,
        x=lambda time: at(time)[0][0] + 0.5 * np.sin(at(time)[1]),
        y=lambda time: at(time)[0][1] - 0.5 * np.cos(at(time)[1]),
        speed=6.0,
    )
    assert deviations(history, path) == pytest.approx(np.full(4000, -0.5), abs=1e-6)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 1e200])
def test_a_place_that_is_none_has_no_deviation(wrong: float, made_up):
    path = make_path(PathSettings(kind="circle"))
    x = np.linspace(0, 5, 100)
    x[-1] = wrong
    with np.errstate(all="ignore"):
        found = deviations(made_up(1, x=x, speed=5.0), path)
    assert not np.isfinite(found[-1]) or abs(found[-1]) > 1e100
