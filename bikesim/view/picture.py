"""A pose shown in a scene, as a picture."""

import mujoco
import numpy as np

from bikesim.errors import InputError
from bikesim.view.drawing import Picture
from bikesim.view.pose import Pose
from bikesim.view.quality import EFFORTS, Quality, drawn_size
from bikesim.view.scene import Scene


class Painter:
    """Draws a scene off screen for boxes of one size, in as many pixels as the quality asks."""

    def __init__(self, scene: Scene, width: int, height: int, quality: Quality) -> None:
        self._scene = scene
        self._drawn = drawn_size(width, height, quality)
        self._renderer = renderer(scene.model, *self._drawn, quality)
        scene.prepare(self._renderer.scene)
        self._buffer = np.empty((self._drawn[1], self._drawn[0], 3), np.uint8)

    def paint(self, pose: Pose, view: str) -> Picture:
        """A pose from a view, in the pixels that are drawn. Only valid until the next."""
        self._scene.show(pose)
        camera, option = self._scene.camera(view), self._scene.option(view)
        self._renderer.update_scene(self._scene.data, camera, option)
        return self._renderer.render(out=self._buffer)

    def close(self) -> None:
        """Let the OpenGL context go."""
        self._renderer.close()


def renderer(model: mujoco.MjModel, width: int, height: int, quality: Quality) -> mujoco.Renderer:
    """MuJoCo's renderer of a model as a quality asks; sets the model's visual quality.

    Raises InputError for a size that OpenGL refuses.
    """
    effort = EFFORTS[quality]
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.quality.offsamples = effort.samples
    model.vis.quality.shadowsize = effort.shadows
    model.vis.quality.numslices = effort.roundness
    model.vis.quality.numstacks = effort.roundness // 2
    try:
        made = mujoco.Renderer(model, height, width)
    except (mujoco.FatalError, RuntimeError, ValueError, MemoryError, ImportError) as error:
        raise InputError(
            f"OpenGL cannot draw a picture of {width}x{height} pixels here: {error}"
        ) from None
    made.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = effort.shadows > 0
    return made
