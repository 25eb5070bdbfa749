"""A scene that a pose of the bicycle is shown in, and the two that there are: `Scene`.

`road_scene`: the rider's display, views "first" and "second". `bench_scene`: the rig, view "bench".
"""

from typing import Protocol

import mujoco
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.view.bench import bench_scene
from bikesim.view.pose import Pose
from bikesim.view.road_scene import RoadScene

__all__ = ["Scene", "bench_scene", "road_scene"]


class Scene(Protocol):
    """What a pose can be shown in, and then rendered from.

    `mujoco.Renderer(scene.model, ...)`; once `scene.prepare(renderer.scene)`; for each picture
    `scene.show(pose)` and `renderer.update_scene(scene.data, scene.camera(view),
    scene.option(view))`. A pose alone decides the picture: nothing is kept from the one before.
    """

    model: mujoco.MjModel
    data: mujoco.MjData

    @property
    def views(self) -> tuple[str, ...]:
        """The views that there are."""
        ...

    def show(self, pose: Pose) -> None:
        """Puts everything where the pose has it; kinematics are done."""
        ...

    def camera(self, view: str) -> str | mujoco.MjvCamera:
        """The camera of a view. Raises InputError for one that there is not."""
        ...

    def option(self, view: str) -> mujoco.MjvOption:
        """What is visible in a view: the rider does not see his own head."""
        ...

    def prepare(self, drawn: mujoco.MjvScene) -> None:
        """Sets what the scene needs of a renderer, once; the renderer's shadows are set before."""
        ...


def road_scene(bicycle: Bicycle, *, path: NDArray | None = None, roll_cue: bool = True) -> Scene:
    """A bicycle with its rider on a country road.

    `path`: the prescribed path, (n, 2) [m], x forward and y to the right; None is the line y = 0.
    Without `roll_cue` the bicycle is drawn upright in all views, so that no lean is to be seen.
    """
    return RoadScene(bicycle, path=path, roll_cue=roll_cue)
