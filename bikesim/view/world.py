"""The land and the road about the bicycle, which stays at the origin while they move past it."""

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from bikesim.data import data_path
from bikesim.errors import InputError
from bikesim.view import textures
from bikesim.view.clearing import Clearing
from bikesim.view.shapes import land
from bikesim.view.shapes.land import SQUARE, STRETCH, WINDOW
from bikesim.view.shapes.mesh import add_mesh
from bikesim.view.shapes.plants import FAR, NEAR
from bikesim.view.window import in_sight, mocap_ids, wrapped

_NEAR_ENOUGH = 105.0  # m to the middle of a piece, within which it is drawn finely
_LEVEL, _SUNK = 150.0, 350.0  # m: farther things sink, as if over the horizon, until not drawn
_DEPTH = 11.0  # m, more than the highest tree
_FIELDS, _ROADSIDES = 9, 4  # different ones


def world_spec() -> mujoco.MjSpec:
    """mjcf/world.xml, painted, still to be changed. Raises InputError."""
    path = data_path("mjcf", "world.xml")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None
    textures.paint(spec)
    return spec


class World:
    """Adds the land to a model, and puts it where it belongs for a place of the bicycle.

    Each piece lies at one place of a window of `WINDOW` metres; when it is half a window behind,
    it reappears as far ahead, both along the road and across. The land is thus periodic.
    """

    def __init__(self, spec: mujoco.MjSpec, path: NDArray[np.float64] | None = None) -> None:
        """`path` (n, 2) [m], x forward and y left: where it leads off the road, nothing stands."""
        self._clearing = Clearing(path)
        _add_shapes(spec)
        pieces = _pieces()
        for piece in pieces:
            body = spec.worldbody.add_body(name=piece.name, mocap=True)
            for detail in ("near", "far"):
                body.add_geom(
                    spec.find_default("land"),
                    name=f"{piece.name} {detail}",
                    meshname=f"{piece.shape} {detail}",
                )
        self._names = [piece.name for piece in pieces]
        self._homes = np.array([piece.home for piece in pieces])
        self._along = np.array([piece.along for piece in pieces])

    def bind(self, model: mujoco.MjModel) -> None:
        """Looks up the pieces in the compiled model."""
        self._mocap = mocap_ids(model, self._names)
        self._near = np.array([model.geom(f"{name} near").id for name in self._names])
        self._far = np.array([model.geom(f"{name} far").id for name in self._names])
        self._ground, self._road = mocap_ids(model, ["ground", "road"])

    def place(
        self, model: mujoco.MjModel, data: mujoco.MjData, x: float, y: float, heading: float
    ) -> None:
        """Moves all to where a bicycle at x, y (y to the left) [m] sees it.

        What is behind it or far off is not drawn. Far things rise out of the ground as they come
        nearer, so that none appears suddenly. `heading` > 0 is to the right [rad].
        """
        here = np.array([x, y])
        offset = wrapped(self._homes - here, WINDOW)
        offset[self._along, 1] = -y
        distance = np.hypot(offset[:, 0], offset[:, 1])
        far = np.clip((distance - _LEVEL) / (_SUNK - _LEVEL), 0, 1)
        data.mocap_pos[self._mocap, :2] = offset
        data.mocap_pos[self._mocap, 2] = -_DEPTH * far**1.5
        drawn, near = in_sight(offset, heading) & (far < 1), distance < _NEAR_ENOUGH
        drawn &= ~self._cleared(offset + here)
        model.geom_rgba[self._near, 3] = drawn & near
        model.geom_rgba[self._far, :3] = 1.0
        model.geom_rgba[self._far, 3] = (drawn & ~near) * (1 - 0.6 * far)
        data.mocap_pos[self._ground, :2] = wrapped(-here, textures.GRASS_PERIOD)
        data.mocap_pos[self._road, :2] = [wrapped(-here, textures.ASPHALT_PERIOD)[0], -y]

    def _cleared(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        cleared = self._clearing.squares(places)
        cleared[self._along] = self._clearing.stretches(places[self._along, 0])
        return cleared


class _Piece(NamedTuple):
    """A piece of land: its shape, its home in the window [m], if it only moves along the road."""

    name: str
    shape: str
    home: tuple[float, float]
    along: bool


def _pieces() -> list[_Piece]:
    """All of the window; the middle row of squares has the road in it."""
    pieces = []
    count = round(WINDOW / SQUARE)
    for i in range(count):
        for j in range(count):
            kind, variant = ("field", (2 * i + 5 * j + i * j) % _FIELDS) if j else ("verge", i)
            home = (i * SQUARE, j * SQUARE)
            pieces.append(_Piece(f"{kind} at {i} {j}", f"{kind} {variant % _FIELDS}", home, False))
    for k in range(round(WINDOW / STRETCH)):
        shape = f"roadside {(3 * k) % _ROADSIDES}"
        pieces.append(_Piece(f"roadside at {k}", shape, (k * STRETCH, 0.0), True))
    return pieces


def _add_shapes(spec: mujoco.MjSpec) -> None:
    """The meshes of the pieces, fine and coarse."""
    for name, detail in (("near", NEAR), ("far", FAR)):
        for k in range(_FIELDS):
            add_mesh(spec, f"field {k} {name}", land.field(k, detail, road=False))
            add_mesh(spec, f"verge {k} {name}", land.field(k, detail, road=True))
        for k in range(_ROADSIDES):
            add_mesh(spec, f"roadside {k} {name}", land.stretch(k, detail))
