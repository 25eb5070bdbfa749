"""The prescribed path as a ribbon on the ground, of which the part about the bicycle is laid out.

The path is cut into pieces of about a metre; four make a longer piece, sixteen the longest. Which
of them are laid depends on their distance alone, so the ribbon neither jumps nor costs more on a
long path, and it may close or cross itself.
"""

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bikesim.errors import InputError
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import Mesh, add_mesh, polygon

HALF_WIDTH = 0.07  # m
_JOIN = 4
_BLOCK = _JOIN * _JOIN
_FINE, _MIDDLE, _FAR = 24.0, 85.0, 330.0  # m, up to where pieces of each length are laid
_POOLS = (96, 80, 64)
_STEP = 0.0002  # m
_AWAY = -5.0  # m, under the ground: where a piece is that is not needed

Array = NDArray[np.float64]


class _Level(NamedTuple):
    """Pieces of one length: middles (n, 2) [m], directions [rad], in the scene's axes."""

    middles: Array
    yaw: Array


class Ribbon:
    """A path, (n, 2) points [m] x forward and y right, in a model. Raises InputError."""

    def __init__(self, spec: mujoco.MjSpec, path: ArrayLike) -> None:
        points = _even_points(_checked(path) * [1, -1])
        self._levels = [_level(points, stride) for stride in (1, _JOIN, _BLOCK)]
        piece = float(np.linalg.norm(np.diff(points, axis=0), axis=1).max())
        for k, stride in enumerate((1, _JOIN, _BLOCK)):
            add_mesh(spec, f"ribbon {k}", _sheet(0.5 * piece * stride + 0.25 * HALF_WIDTH))
            for n in range(_POOLS[k]):
                body = spec.worldbody.add_body(name=f"ribbon {k} {n}", mocap=True)
                body.add_geom(spec.find_default("land"), meshname=f"ribbon {k}")

    def bind(self, model: mujoco.MjModel) -> None:
        """Looks up the pieces in the compiled model."""
        self._pools = [
            np.array([model.body_mocapid[model.body(f"ribbon {k} {n}").id] for n in range(count)])
            for k, count in enumerate(_POOLS)
        ]

    def place(self, data: mujoco.MjData, x: float, y: float, reach: float = math.inf) -> None:
        """Lays the pieces about a bicycle at x, y (y to the left), up to `reach` away [m]."""
        here = np.array([x, y])
        blocks = self._distance(2, here)
        far = np.flatnonzero((blocks > _MIDDLE) & (blocks < _FAR))
        within = _children(np.flatnonzero(blocks <= _MIDDLE))
        apart = self._distance(1, here, within)
        fine = _children(within[apart <= _FINE])
        for k, chosen in enumerate((fine, within[apart > _FINE], far)):
            self._lay(data, k, self._reached(k, chosen, here, reach), here)

    def _distance(self, level: int, here: Array, chosen: NDArray | slice = slice(None)) -> Array:
        offset = self._levels[level].middles[chosen] - here
        return np.hypot(offset[:, 0], offset[:, 1])

    def _reached(self, level: int, chosen: NDArray, here: Array, reach: float) -> NDArray:
        return chosen if reach > _FAR else chosen[self._distance(level, here, chosen) < reach]

    def _lay(self, data: mujoco.MjData, level: int, chosen: NDArray, here: Array) -> None:
        pool, pieces = self._pools[level], self._levels[level]
        if len(chosen) > len(pool):  # a path that winds much: what is nearest matters
            chosen = chosen[np.argsort(self._distance(level, here, chosen))[: len(pool)]]
        data.mocap_pos[pool] = [0, 0, _AWAY]
        used = pool[: len(chosen)]
        data.mocap_pos[used, :2] = np.round(pieces.middles[chosen] - here, 7)
        # Two sheets in one plane would be lit twice where they overlap.
        data.mocap_pos[used, 2] = _STEP * (2 * level + chosen % 2)
        data.mocap_quat[used] = 0.0
        data.mocap_quat[used, 0] = np.cos(0.5 * pieces.yaw[chosen])
        data.mocap_quat[used, 3] = np.sin(0.5 * pieces.yaw[chosen])


def _checked(path: ArrayLike) -> Array:
    points = np.asarray(path, float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise InputError(
            f"path of shape {points.shape}: two or more finite points (x, y) [m] are needed"
        )
    if not np.ptp(points, axis=0).any():
        raise InputError("path: all its points are the same, a line is needed")
    return points


def _even_points(points: Array) -> Array:
    """The path at equal distances of at most a metre, in whole blocks."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    keep = np.concatenate([[True], steps > 0])
    count = _BLOCK * math.ceil(along[-1] / _BLOCK)
    at = np.linspace(0, along[-1], count + 1)
    return np.stack([np.interp(at, along[keep], points[keep, k]) for k in (0, 1)], axis=1)


def _level(points: Array, stride: int) -> _Level:
    ends = points[::stride]
    across = np.diff(ends, axis=0)
    return _Level(0.5 * (ends[1:] + ends[:-1]), np.arctan2(across[:, 1], across[:, 0]))


def _children(blocks: NDArray) -> NDArray:
    """The shorter pieces that make these up."""
    return (blocks[:, None] * _JOIN + np.arange(_JOIN)).ravel()


def _sheet(half: float) -> Mesh:
    w = HALF_WIDTH
    return polygon([[-half, -w, 0], [half, -w, 0], [half, w, 0], [-half, w, 0]], Colour.RIBBON)
