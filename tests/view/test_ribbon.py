"""The prescribed path on the ground."""

import math

import mujoco
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.view.ribbon import HALF_WIDTH, Ribbon
from bikesim.view.world import world_spec


def laid(path: np.ndarray, x: float, y: float, reach: float = math.inf) -> np.ndarray:
    """Middles of the pieces that lie on the ground, in the record's axes [m]."""
    spec = world_spec()
    ribbon = Ribbon(spec, path)
    model = spec.compile()
    data = mujoco.MjData(model)
    ribbon.bind(model)
    ribbon.place(data, x, -y, reach)
    pieces = [k for k in range(model.nbody) if model.body(k).name.startswith("ribbon")]
    places = data.mocap_pos[model.body_mocapid[pieces]]
    return (places[places[:, 2] > -1] + [x, -y, 0])[:, :2] * [1, -1]


def circle(radius: float) -> np.ndarray:
    angle = np.linspace(0, 2 * math.pi, 400)
    return radius * np.stack([np.sin(angle), 1 - np.cos(angle)], 1)


def test_pieces_lie_on_the_path():
    places = laid(circle(30.0), 0.0, 0.0)
    off = np.hypot(places[:, 0], places[:, 1] - 30.0) - 30.0
    assert len(places) > 60
    assert np.abs(off).max() < 0.5 * HALF_WIDTH + 0.3


def test_nearby_it_is_exact_to_a_centimetre():
    places = laid(circle(30.0), 0.0, 0.0)
    near = places[np.hypot(*places.T) < 15]
    assert np.abs(np.hypot(near[:, 0], near[:, 1] - 30.0) - 30.0).max() < 0.01


def test_a_path_to_the_right_turns_to_the_right():
    places = laid(circle(30.0), 0.0, 0.0)
    assert places[:, 1].max() > 50
    assert places[:, 1].min() > -1


def test_far_along_a_long_path_only_what_is_near_is_laid():
    path = np.array([[0.0, 2.0], [20000.0, 2.0]])
    places = laid(path, 12345.0, 0.0)
    assert len(places) < 200
    assert np.ptp(places[:, 0]) < 700
    assert np.allclose(places[:, 1], 2.0)


@pytest.mark.parametrize("reach", [6.0, 60.0, 200.0])
def test_of_a_preview_nothing_farther_is_laid(reach: float):
    path = np.array([[-500.0, 0.0], [1000.0, 0.0]])
    near = laid(path, 10.0, 0.0, reach)[:, 0] - 10
    whole = laid(path, 10.0, 0.0)[:, 0] - 10
    assert sorted(near) == sorted(whole[np.abs(whole) < reach])
    assert near.max() > reach - 17  # the longest piece


def test_beside_the_path_it_is_whole():
    places = laid(np.array([[-500.0, 0.0], [500.0, 0.0]]), 10.0, 3.0)
    ahead = np.sort(places[np.abs(places[:, 0] - 10) < 20, 0])
    assert np.diff(ahead).max() < 1.01


@pytest.mark.parametrize("path", [[[0, 0]], [[0, 0, 0], [1, 1, 1]], [[0, 0], [math.nan, 1]]])
def test_what_is_no_path_is_refused(path: list[list[float]]):
    with pytest.raises(InputError, match="two or more finite points"):
        Ribbon(world_spec(), np.array(path))


def test_a_path_without_length_is_refused():
    with pytest.raises(InputError, match="a line is needed"):
        Ribbon(world_spec(), np.zeros((3, 2)))
