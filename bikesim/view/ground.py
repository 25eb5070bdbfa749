"""The ground: the meadow, the road on it, and the road's markings."""

import mujoco
import numpy as np

from bikesim.view import textures
from bikesim.view.ribbon import HALF_WIDTH
from bikesim.view.shapes import land
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import Mesh, add_mesh, joined, polygon

_LOW = -0.010  # m, of the meadow; the wheels run on z = 0
_MEADOW_HALF = 1200.0  # m, a whole number of periods of its texture
_ROAD_HALF = 600.0  # m of road before and behind
_MARK_WIDTH = 0.06  # m, half


def add_ground(spec: mujoco.MjSpec, *, ribbon: bool) -> None:
    """Road and meadow, bodies `road` and `ground`; the path y = 0 as a `ribbon`, if wanted.

    To be called when all else is in the model: things are drawn in the order of their bodies, and
    what is hidden by something drawn before costs nothing.
    """
    road = spec.worldbody.add_body(name="road", mocap=True)
    _add(spec, road, "road markings", _markings(ribbon=ribbon), "matt")
    _add(spec, road, "road", _road_surface(), "asphalt")
    ground = spec.worldbody.add_body(name="ground", mocap=True)
    _add(spec, ground, "ground", _meadow(), "grass")


def _add(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, mesh: Mesh, material: str) -> None:
    add_mesh(spec, name, mesh)
    body.add_geom(spec.find_default("land"), name=name, meshname=name, material=material)


def _meadow() -> Mesh:
    """One sheet: MuJoCo would draw a plane as a grid of many thousand triangles."""
    corners = _MEADOW_HALF * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    sheet = polygon(np.insert(corners, 2, _LOW, axis=1), Colour.MEADOW)
    return sheet._replace(texture=corners / textures.GRASS_PERIOD)


def _road_surface() -> Mesh:
    period = textures.ASPHALT_PERIOD
    low, high = land.RIGHT_EDGE - 0.45, land.LEFT_EDGE + 0.45
    sheets = []
    for x in np.arange(-_ROAD_HALF, _ROAD_HALF, 2 * period):
        corners = np.array(
            [[x, low, -0.004], [x + 2 * period, low, -0.004], [x + 2 * period, high, -0.004],
             [x, high, -0.004]]
        )  # fmt: skip
        sheet = polygon(corners, Colour.MARKING)
        sheets.append(sheet._replace(texture=(corners[:, :2] - [x, 0]) / period))
    return joined(sheets)


def _markings(*, ribbon: bool) -> Mesh:
    """Edge lines, the broken centre line, and the path where that is the line y = 0."""
    period = textures.ASPHALT_PERIOD
    lines = []
    for x in np.arange(-_ROAD_HALF, _ROAD_HALF, period):
        lines += [
            _strip(x, x + period, y, _MARK_WIDTH, -0.001, Colour.MARKING)
            for y in (land.RIGHT_EDGE, land.LEFT_EDGE)
        ]
        lines.append(_strip(x, x + 3.5, land.CENTRE, _MARK_WIDTH, -0.001, Colour.MARKING))
        if ribbon:
            lines.append(_strip(x, x + period, 0.0, HALF_WIDTH, 0.0, Colour.RIBBON))
    return joined(lines)


def _strip(x0: float, x1: float, y: float, half: float, z: float, colour: Colour) -> Mesh:
    """A rectangle on the ground [m]."""
    corners = [[x0, y - half, z], [x1, y - half, z], [x1, y + half, z], [x0, y + half, z]]
    return polygon(corners, colour)
