"""The bench: the rig of mjcf/rig.xml in its room, the bar at the recorded steer."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from bikesim.data import data_path
from bikesim.errors import InputError, unknown
from bikesim.model.bicycle import Bicycle
from bikesim.rig.mjcf import rig_spec
from bikesim.view.pose import Pose
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import add_mesh, polygon
from bikesim.view.textures import replace_texture, road_ahead


class BenchScene:
    """View "bench"; see `Scene`."""

    views = ("bench",)

    def __init__(self, bicycle: Bicycle) -> None:
        spec = rig_spec()
        half = bicycle.steer_axis_tilt / 2
        spec.body("head").quat[:] = [math.cos(half), 0, -math.sin(half), 0]
        _show_on_the_screen(spec, road_ahead())
        spec.attach(_room(), prefix="room ", frame=spec.worldbody.add_frame())
        spec.visual.global_.offwidth, spec.visual.global_.offheight = 3840, 2160
        self.model: mujoco.MjModel = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._screen = self.model.texture("screen").id
        rows, columns = road_ahead().shape[:2]
        self.screen_size = columns, rows
        """Width and height in pixels of the picture on the screen before the rider."""
        self._steer = int(self.model.joint("steer").qposadr[0])
        self.show(Pose(0, 0, 0, 0, 0, 0, 0, 0))

    def show(self, pose: Pose) -> None:
        self.data.qpos[self._steer] = pose.steer
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def put_on_the_screen(self, picture: NDArray[np.uint8]) -> int:
        """A picture of that size; gives the texture, which a renderer must be given anew."""
        begin = int(self.model.tex_adr[self._screen])
        self.model.tex_data[begin : begin + picture.size] = picture.ravel()
        return self._screen

    def camera(self, view: str) -> str:
        if view not in self.views:
            raise unknown("view", view, self.views)
        return view

    def option(self, view: str) -> mujoco.MjvOption:
        self.camera(view)
        return mujoco.MjvOption()

    def prepare(self, drawn: mujoco.MjvScene) -> None:
        drawn.flags[mujoco.mjtRndFlag.mjRND_FOG] = False


def _room() -> mujoco.MjSpec:
    path = data_path("mjcf", "room.xml")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None


def _show_on_the_screen(spec: mujoco.MjSpec, picture: NDArray[np.uint8]) -> None:
    """On the box `picture` of mjcf/rig.xml: a sheet just before it."""
    screen = spec.geom("picture")
    a, b, c = screen.size
    corners = [[-a, -b, c + 0.001], [a, -b, c + 0.001], [a, b, c + 0.001], [-a, b, c + 0.001]]
    sheet = polygon(corners, Colour.STEEL)
    add_mesh(spec, "screen", sheet._replace(texture=np.array([[0, 1], [1, 1], [1, 0], [0, 0.0]])))
    texture = spec.add_texture(name="screen", type=mujoco.mjtTexture.mjTEXTURE_2D)
    replace_texture(texture, picture)
    material = spec.add_material(name="screen", emission=0.45, specular=0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "screen"
    material.rgba[:3] = 0.75
    screen.type, screen.meshname, screen.material = mujoco.mjtGeom.mjGEOM_MESH, "screen", "screen"


def bench_scene(bicycle: Bicycle) -> BenchScene:
    """The rig with the head angle of a bicycle."""
    return BenchScene(bicycle)
