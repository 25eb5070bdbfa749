"""The rider's display: a bicycle with its rider on a country road."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from bikesim.errors import unknown
from bikesim.model.bicycle import Bicycle
from bikesim.view.contact import wheel_geometry
from bikesim.view.crops import Crops
from bikesim.view.cyclist import CASTER, Cyclist
from bikesim.view.ground import add_ground
from bikesim.view.pose import Pose
from bikesim.view.ribbon import Ribbon
from bikesim.view.world import World, world_spec

_OWN_BODY = 3  # the group of mjcf/world.xml that the rider's own eyes do not see
_STRAIGHT = np.array([[-1e3, 0.0], [3e4, 0.0]])  # m, where only some of it is drawn
_SHADE, _HIDDEN = (0.03, 0.04, 0.05, 0.075), (0, 0, 0, 0)


class RoadScene:
    """Views "first", from the rider's eyes, and "second", from behind; see `Scene`."""

    views = ("first", "second")

    def __init__(
        self,
        bicycle: Bicycle,
        *,
        path: NDArray | None,
        roll_cue: bool,
        preview: float | None = None,
    ) -> None:
        """`preview` [s]: of riding, so far ahead the path is drawn; None: all of it."""
        if path is None and preview is not None:
            path = _STRAIGHT
        self._preview = preview
        spec = world_spec()
        self._cyclist = Cyclist(spec, wheel_geometry(bicycle))
        self._world = World(spec, None if path is None else path * [1, -1])
        self._crops = Crops(spec)
        self._ribbon = None if path is None else Ribbon(spec, path)
        add_ground(spec, ribbon=path is None)
        self._roll_cue = roll_cue
        self.model: mujoco.MjModel = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._world.bind(self.model)
        self._crops.bind(self.model)
        if self._ribbon:
            self._ribbon.bind(self.model)
        self._cyclist.bind(self.model)
        self._shade = self.model.geom("shade").id
        names = [self.model.geom(k).name for k in range(self.model.ngeom)]
        self._casters = [k for k, name in enumerate(names) if name.endswith(CASTER)]
        self.show(Pose(0, 0, 0, 0, 0, 0, 0, 0))

    def show(self, pose: Pose) -> None:
        roll = pose.roll if self._roll_cue else 0.0
        for part in (self._world, self._crops):
            part.place(self.model, self.data, pose.x, -pose.y, pose.heading)
        if self._ribbon:
            ahead = math.inf if self._preview is None else self._preview * pose.speed
            self._ribbon.place(self.data, pose.x, -pose.y, ahead)
        self._cyclist.show(self.model, self.data, pose.heading, roll, pose.steer, pose.distance)
        mujoco.mj_camlight(self.model, self.data)

    def camera(self, view: str) -> str:
        if view not in self.views:
            raise unknown("view", view, self.views)
        return view

    def option(self, view: str) -> mujoco.MjvOption:
        option = mujoco.MjvOption()
        option.geomgroup[_OWN_BODY] = self.camera(view) != "first"
        return option

    def prepare(self, drawn: mujoco.MjvScene) -> None:
        # OpenGL's fog would hide the sky, which is as far off as anything.
        drawn.flags[mujoco.mjtRndFlag.mjRND_FOG] = False
        drawn.flags[mujoco.mjtRndFlag.mjRND_HAZE] = False
        # Where no shadow is cast, a soft one under the wheels holds the bicycle to the ground.
        cast = bool(drawn.flags[mujoco.mjtRndFlag.mjRND_SHADOW])
        self.model.geom_rgba[self._shade] = _HIDDEN if cast else _SHADE
        self.model.geom_rgba[self._casters, 3] = cast
