"""Fields of crops: tinted sheets with rows, flat on the meadow."""

import mujoco
import numpy as np

from bikesim.view import textures
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.land import SQUARE, WINDOW
from bikesim.view.shapes.mesh import Mesh, add_mesh, polygon
from bikesim.view.window import in_sight, mocap_ids, wrapped

_HEIGHT = -0.007  # m: over the meadow, under the road
_CLEAR, _LOST = 230.0, 345.0  # m, between which a field fades
_SIZES = ((36.0, 33.0), (28.0, 36.0), (37.0, 26.0))  # m, half
_TINTS = (
    (0.93, 0.84, 0.50), (0.62, 0.78, 0.36), (0.72, 0.58, 0.43), (0.86, 0.82, 0.36),
    (0.56, 0.71, 0.40),
)  # fmt: skip


class Crops:
    """Adds fields to a model, one in most squares of the land beside the road."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        for k, (half_x, half_y) in enumerate(_SIZES):
            add_mesh(spec, f"crop {k}", _sheet(half_x, half_y))
        count = round(WINDOW / SQUARE)
        places = [(i, j) for i in range(count) for j in range(1, count) if (i + 3 * j) % 4]
        self._homes = SQUARE * np.array(places)
        self._names = [f"crop at {i} {j}" for i, j in places]
        for name, (i, j) in zip(self._names, places, strict=True):
            body = spec.worldbody.add_body(name=name, mocap=True)
            body.add_geom(
                spec.find_default("land"),
                name=name,
                meshname=f"crop {(i * j + i) % len(_SIZES)}",
                material="crops",
                rgba=[*_TINTS[(2 * i + 3 * j + i * j) % len(_TINTS)], 1],
            )

    def bind(self, model: mujoco.MjModel) -> None:
        """Looks up the fields in the compiled model."""
        self._mocap = mocap_ids(model, self._names)
        self._geoms = np.array([model.geom(name).id for name in self._names])

    def place(
        self, model: mujoco.MjModel, data: mujoco.MjData, x: float, y: float, heading: float
    ) -> None:
        """Moves all to where a bicycle at x, y (y to the left) [m] sees it."""
        offset = wrapped(self._homes - [x, y], WINDOW)
        data.mocap_pos[self._mocap, :2] = offset
        distance = np.hypot(offset[:, 0], offset[:, 1])
        clear = np.clip((_LOST - distance) / (_LOST - _CLEAR), 0, 1)
        model.geom_rgba[self._geoms, 3] = clear * in_sight(offset, heading)


def _sheet(half_x: float, half_y: float) -> Mesh:
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [half_x, half_y]
    sheet = polygon(np.insert(corners, 2, _HEIGHT, axis=1), Colour.MEADOW)
    return sheet._replace(texture=corners / textures.ROWS_PERIOD)
