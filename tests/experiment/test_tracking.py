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


@pytest.mark.parametrize("kind", ["circle", "figure-eight", "double-lane-change", "slalom"])
def test_the_deviation_that_was_put_in(kind: str, made_up):
    """Over several laps of the closed ones, crossings and all."""
    path = make_path(PathSettings(kind=kind))

    def put_in(time: np.ndarray) -> np.ndarray:
        return 0.3 + 0.2 * np.sin(0.7 * time)

    history = beside(path, made_up, put_in, seconds=90)
    assert deviations(history, path) == pytest.approx(put_in(history.time), abs=1e-4)
