"""Where the prescribed path leads off the road: no tree may stand there."""

import numpy as np
from numpy.typing import NDArray

from bikesim.view.shapes.land import LEFT_EDGE, RIGHT_EDGE, SQUARE, STRETCH

Array = NDArray[np.float64]
Where = NDArray[np.bool_]

_REACH = 12.0  # m past its edge that trees of a square may stand, with room to ride past them
_POSTS, _TREES = 0.5, 10.0  # m beside the lines of the road, from where on things stand
_FAR = 1 << 20  # squares; more than a path is long


class Clearing:
    """The pieces of land that a path leads through; `path` (n, 2) [m], x forward and y left."""

    def __init__(self, path: Array | None) -> None:
        points = np.empty((0, 2)) if path is None else path
        squares = _near(points, SQUARE)
        verge = _near(points[_beside_the_road(points, _TREES)], SQUARE)
        self._squares = np.unique(_code(np.concatenate([squares[squares[:, 1] != 0], verge])))
        stretches = _near(points[_beside_the_road(points, _POSTS)], STRETCH)
        self._stretches = np.unique(stretches[stretches[:, 1] == 0, 0])

    def squares(self, middles: Array) -> Where:
        """Which squares, by their middles (n, 2) [m], are to be clear."""
        return np.isin(_code(np.rint(middles / SQUARE).astype(int)), self._squares)

    def stretches(self, middles: Array) -> Where:
        """Which pieces of roadside are, by x (n,) [m] of their middles."""
        return np.isin(np.rint(middles / STRETCH).astype(int), self._stretches)


def _beside_the_road(points: Array, beyond: float) -> Where:
    return (points[:, 1] < RIGHT_EDGE - beyond) | (points[:, 1] > LEFT_EDGE + beyond)


def _near(points: Array, side: float) -> NDArray[np.int_]:
    """The squares of a side [m] that these points are in or nearly in, as numbers (m, 2)."""
    corners = [points + [dx, dy] for dx in (-_REACH, _REACH) for dy in (-_REACH, _REACH)]
    return np.unique(np.rint(np.concatenate(corners) / side).astype(int), axis=0)


def _code(squares: NDArray[np.int_]) -> NDArray[np.int_]:
    """A pair of numbers as one."""
    return squares[..., 0] * (2 * _FAR) + squares[..., 1]
