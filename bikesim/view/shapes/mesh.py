"""Solids as triangles: small meshes with normals and a colour for each corner, to be joined."""

import math
from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bikesim.view.shapes.colour import Colour, texture_coordinate

Array = NDArray[np.float64]

_NO_AREA = 1e-12  # m², twice that of a triangle that is none


class Mesh(NamedTuple):
    """Corners (n, 3) [m] with normals (n, 3) and texture coordinates (n, 2), triangles (m, 3)."""

    corners: Array
    normals: Array
    texture: Array
    triangles: NDArray[np.int64]

    def moved(self, to: ArrayLike = (0, 0, 0), turn: ArrayLike | None = None) -> "Mesh":
        """Turned by a rotation matrix, then moved [m]."""
        matrix = np.eye(3) if turn is None else np.asarray(turn, float)
        corners = self.corners @ matrix.T + np.asarray(to, float)
        return self._replace(corners=corners, normals=self.normals @ matrix.T)

    def mirrored(self) -> "Mesh":
        """The same on the other side of the plane y = 0."""
        flip = np.array([1.0, -1.0, 1.0])
        return self._replace(
            corners=self.corners * flip,
            normals=self.normals * flip,
            triangles=self.triangles[:, ::-1],
        )


def vec(x: float, y: float, z: float) -> Array:
    """A place or a direction."""
    return np.array([x, y, z], float)


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """All of them as one."""
    parts = list(meshes)
    starts = np.cumsum([0, *(len(part.corners) for part in parts[:-1])])
    return Mesh(
        np.concatenate([part.corners for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.texture for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
    )


def both_sides(mesh: Mesh) -> Mesh:
    """It and its mirror image."""
    return joined([mesh, mesh.mirrored()])


def add_mesh(spec: mujoco.MjSpec, name: str, mesh: Mesh) -> None:
    """Puts a mesh among the assets of a model that is being made."""
    asset = spec.add_mesh(name=name)
    asset.uservert = mesh.corners.ravel().tolist()
    asset.usernormal = mesh.normals.ravel().tolist()
    asset.usertexcoord = mesh.texture.ravel().tolist()
    for field in ("userface", "userfacenormal", "userfacetexcoord"):
        setattr(asset, field, mesh.triangles.ravel().tolist())
    # Nothing here has mass; a shell may be open, a volume may not.
    asset.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL


def surface(grid: Array, normals: Array, colour: Colour, *, closed: bool) -> Mesh:
    """A sheet of corners (rows, columns, 3); `closed` joins the last column to the first."""
    rows, columns, _ = grid.shape
    triangles, corners = _grid_triangles(rows, columns, closed), grid.reshape(-1, 3)
    start, *ends = corners[triangles.T]
    (a, b, c), (d, e, f) = ((end - start).T for end in ends)
    square = (b * f - c * e) ** 2 + (c * d - a * f) ** 2 + (a * e - b * d) ** 2
    return Mesh(
        corners,
        unit(normals.reshape(-1, 3)),
        _coordinates(colour, rows * columns),
        triangles[square > _NO_AREA**2],
    )


@cache
def _grid_triangles(rows: int, columns: int, closed: bool) -> NDArray[np.int64]:
    """Two for each cell of a grid."""
    index = np.arange(rows * columns).reshape(rows, columns)
    after = np.roll(index, -1, axis=1) if closed else index[:, 1:]
    before = index if closed else index[:, :-1]
    a, b, c, d = before[:-1], after[:-1], after[1:], before[1:]
    return np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )


@cache
def _circle(sides: int) -> tuple[Array, Array]:
    """Cosines and sines of as many angles."""
    angle = 2 * math.pi * np.arange(sides) / sides
    return np.cos(angle), np.sin(angle)


def polygon(corners: ArrayLike, colour: Colour) -> Mesh:
    """A flat convex one, corners anticlockwise as seen from its front."""
    points = np.asarray(corners, float)
    count = len(points)
    (a, b, c), (d, e, f) = (points[1] - points[0]).tolist(), (points[2] - points[0]).tolist()
    normal = unit(np.array([b * f - c * e, c * d - a * f, a * e - b * d]))
    fan = np.array([[0, k, k + 1] for k in range(1, count - 1)])
    return Mesh(points, np.tile(normal, (count, 1)), _coordinates(colour, count), fan)


def turned_profile(profile: Sequence[tuple[float, float]], colour: Colour, sides: int = 10) -> Mesh:
    """The surface that a line of (radius, z) [m] sweeps about the z axis, from below upwards."""
    line = np.array(profile, float)
    slope = np.empty_like(line)
    slope[0], slope[-1] = line[1] - line[0], line[-1] - line[-2]
    slope[1:-1] = (line[2:] - line[:-2]) / 2
    cos, sin = _circle(sides)
    grid, normals = np.empty((2, len(line), sides, 3))
    for swept, out, up in (
        (grid, line[:, :1], line[:, 1:]),
        (normals, slope[:, 1:], -slope[:, :1]),
    ):
        swept[..., 0], swept[..., 1], swept[..., 2] = out * cos, out * sin, up
    return surface(grid, normals, colour, closed=True)


def limb(
    start: ArrayLike,
    end: ArrayLike,
    radius: float,
    end_radius: float | None = None,
    colour: Colour = Colour.STEEL,
    sides: int = 10,
    rings: int = 3,
) -> Mesh:
    """A rod that may taper, its ends rounded by `rings` rings (0: flat)."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(b - a))
    top = radius if end_radius is None else end_radius
    arc = np.linspace(0, math.pi / 2, rings + 1)
    below = [(radius * math.sin(t), -radius * math.cos(t)) for t in arc]
    above = [(top * math.cos(t), length + top * math.sin(t)) for t in arc]
    if not rings:
        below, above = [(1e-6, 0), (radius, 0)], [(top, length), (1e-6, length)]
    rod = turned_profile([*below, *above], colour, sides)
    return rod.moved(a, aligned(b - a))


def loft(
    sections: Sequence[tuple[float, float, float, float, float]], colour: Colour, sides: int = 14
) -> Mesh:
    """A body of elliptic sections (x, y, z of the middle, half length in x, half width in y) [m].

    From below upwards; ends are closed where the halves are 0.
    """
    x, y, z, long, wide = (np.array(column)[:, None] for column in zip(*sections, strict=True))
    angle = 2 * math.pi * np.arange(sides) / sides
    grid = np.stack([x + long * np.cos(angle), y + wide * np.sin(angle), z + 0 * angle], -1)
    around = np.roll(grid, -1, axis=1) - np.roll(grid, 1, axis=1)
    upward = np.gradient(grid, axis=0)
    normals = np.cross(around, upward)
    normals[0], normals[-1] = [0, 0, -1], [0, 0, 1]
    return surface(grid, normals, colour, closed=True)


def bent_tube(points: ArrayLike, radius: float, colour: Colour, sides: int = 8) -> Mesh:
    """A tube along a line of points (n, 3) [m], open at its ends."""
    line = np.asarray(points, float)
    along = unit(np.gradient(line, axis=0))
    side = np.array([0.0, 0.0, 1.0])
    if abs(along[0] @ side) > 0.9:
        side = np.array([1.0, 0.0, 0.0])
    angle = 2 * math.pi * np.arange(sides) / sides
    normals = []
    for direction in along:
        side = unit(side - (side @ direction) * direction)
        normals.append(
            np.outer(np.cos(angle), side) + np.outer(np.sin(angle), np.cross(direction, side))
        )
    normal = np.array(normals)
    return surface(line[:, None, :] + radius * normal, normal, colour, closed=True)


def ellipsoid(
    centre: ArrayLike, radii: ArrayLike, colour: Colour, sides: int = 14, rings: int = 9
) -> Mesh:
    """Axes along x, y, z."""
    ball, scale = _ball(sides, rings), np.asarray(radii, float)
    return ball._replace(
        corners=ball.corners * scale + np.asarray(centre, float),
        normals=unit(ball.corners / scale),
        texture=_coordinates(colour, len(ball.corners)),
    )


@cache
def _ball(sides: int, rings: int) -> Mesh:
    arc = np.linspace(-math.pi / 2, math.pi / 2, rings)
    return turned_profile([(math.cos(t), math.sin(t)) for t in arc], Colour.STEEL, sides)


def box(centre: ArrayLike, half: ArrayLike, colour: Colour) -> Mesh:
    """Sides along x, y, z; `half` are half the sides [m]."""
    unit_box = _unit_box()
    corners = np.asarray(centre, float) + np.asarray(half, float) * unit_box.corners
    return unit_box._replace(corners=corners, texture=_coordinates(colour, len(corners)))


@cache
def _unit_box() -> Mesh:
    faces = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            n, u = np.eye(3)[axis] * sign, np.eye(3)[(axis + 1) % 3]
            v = np.cross(n, u)
            faces.append(polygon([n + u + v, n - u + v, n - u - v, n + u - v], Colour.STEEL))
    return joined(faces)


def ring(profile: Sequence[tuple[float, float]], colour: Colour, sides: int) -> Mesh:
    """A closed line of (radius, y) [m] swept about the y axis: a tyre, a rim.

    The line runs with y where the radius is greatest.
    """
    line = np.array([*profile, profile[0]], float)
    around = np.array([profile[-1], *profile, profile[0], profile[1]], float)
    slope = around[2:] - around[:-2]
    angle = 2 * math.pi * np.arange(sides) / sides
    cos, sin = np.cos(angle), np.sin(angle)
    radius, y = line[:, :1], np.broadcast_to(line[:, 1:], (len(line), sides))
    grid = np.stack([radius * cos, y, radius * sin], -1)
    outward, sideward = slope[:, 1:], np.broadcast_to(-slope[:, :1], (len(line), sides))
    normals = np.stack([outward * cos, sideward, outward * sin], -1)
    swept = surface(grid, normals, colour, closed=True)
    return swept._replace(triangles=swept.triangles[:, ::-1])


def aligned(direction: ArrayLike) -> Array:
    """A rotation matrix that turns the z axis into a direction."""
    a, b, c = np.asarray(direction, float).tolist()  # floats: this is called for each limb shown
    length = math.sqrt(a * a + b * b + c * c) or 1.0
    a, b, c = a / length, b / length, c / length
    # Square to it and to y; or to x, where it is almost along y.
    d, e, f = (c, 0.0, -a) if abs(b) < 0.9 else (0.0, -c, b)
    length = math.sqrt(d * d + e * e + f * f)
    d, e, f = d / length, e / length, f / length
    return np.array([[d, b * f - c * e, a], [e, c * d - a * f, b], [f, a * e - b * d, c]])


def unit(vectors: Array) -> Array:
    """Vectors (..., 3) made of length 1; those of no length stay."""
    length = np.sqrt((vectors * vectors).sum(-1, keepdims=True))
    length[length == 0] = 1
    return vectors / length


def _coordinates(colour: Colour, count: int) -> Array:
    return np.broadcast_to(texture_coordinate(colour), (count, 2))
