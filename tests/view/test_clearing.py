"""Where nothing stands in the way of a path."""

import numpy as np

from bikesim.view.clearing import Clearing

MIDDLES = 80.0 * np.array([[i, j] for i in range(-3, 4) for j in range(-2, 3)])
STRETCHES = np.array([90.0 * k for k in range(-3, 4)])


def test_along_the_road_all_stays():
    x = np.arange(-300.0, 300.0)
    clearing = Clearing(np.stack([x, 1.5 * np.sin(x / 20)], 1))
    assert not clearing.squares(MIDDLES).any()
    assert not clearing.stretches(STRETCHES).any()


def test_without_a_path_all_stays():
    assert not Clearing(None).squares(MIDDLES).any()


def test_a_path_across_the_land_is_free_and_the_rest_stays():
    y = np.arange(-100.0, 100.0)
    clearing = Clearing(np.stack([0 * y + 10, y], 1))
    cleared = MIDDLES[clearing.squares(MIDDLES)]
    assert cleared.tolist() == [[0, -80], [0, 0], [0, 80]]
    assert STRETCHES[clearing.stretches(STRETCHES)].tolist() == [0]


def test_near_the_edge_of_a_square_the_next_is_free_as_well():
    x = np.arange(30.0, 36.0)
    clearing = Clearing(np.stack([x, 0 * x - 80], 1))
    assert MIDDLES[clearing.squares(MIDDLES)].tolist() == [[0, -80], [80, -80]]
