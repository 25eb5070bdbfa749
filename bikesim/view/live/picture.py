"""A scene drawn straight into a window: nothing is read back from where it is drawn."""

import cv2
import mujoco
import numpy as np

from bikesim.errors import InputError
from bikesim.view.drawing import Picture
from bikesim.view.pose import Pose
from bikesim.view.quality import EFFORTS, Quality, drawn_size
from bikesim.view.scene import Scene

_FONT = mujoco.mjtFontScale.mjFONTSCALE_100
_EYES = mujoco.mjtCatBit.mjCAT_ALL
_MOST_GEOMS = 10_000
_OFF, _WINDOW = mujoco.mjtFramebuffer.mjFB_OFFSCREEN, mujoco.mjtFramebuffer.mjFB_WINDOW


class LivePainter:
    """Draws one scene as a quality asks, off screen, and copies it into the window on the GPU.

    Needs the window's OpenGL to be current, as all of its methods do.
    """

    def __init__(self, scene: Scene, size: tuple[int, int], quality: Quality) -> None:
        """`size`: of the window. Raises InputError where OpenGL cannot draw it."""
        self._scene, self._quality = scene, quality
        effort, model = EFFORTS[quality], scene.model
        model.vis.global_.offwidth, model.vis.global_.offheight = drawn_size(*size, quality)
        model.vis.quality.offsamples = effort.samples
        model.vis.quality.shadowsize = effort.shadows
        model.vis.quality.numslices = effort.roundness
        model.vis.quality.numstacks = effort.roundness // 2
        try:
            self._context = mujoco.MjrContext(model, int(_FONT))
        except (mujoco.FatalError, RuntimeError, MemoryError) as error:
            raise InputError(f"display: OpenGL cannot draw here: {error}") from None
        self._drawn = mujoco.MjvScene(model, _MOST_GEOMS)
        self._drawn.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = effort.shadows > 0
        scene.prepare(self._drawn)

    def draw(self, pose: Pose, view: str, size: tuple[int, int]) -> None:
        """A pose from a view, off screen, for a box of a size in pixels."""
        self._scene.show(pose)
        model, data, context = self._scene.model, self._scene.data, self._context
        mujoco.mjv_updateScene(
            model, data, self._scene.option(view), None, self._camera(view), int(_EYES), self._drawn
        )
        width, height = drawn_size(*size, self._quality)
        if context.offWidth < width or context.offHeight < height:
            mujoco.mjr_resizeOffscreen(width, height, context)
        mujoco.mjr_setBuffer(int(_OFF), context)
        mujoco.mjr_render(mujoco.MjrRect(0, 0, width, height), self._drawn, context)

    def to_window(self, size: tuple[int, int]) -> None:
        """What was drawn last, for the window's size; texts go over it."""
        part = mujoco.MjrRect(0, 0, *drawn_size(*size, self._quality))
        mujoco.mjr_blitBuffer(part, mujoco.MjrRect(0, 0, *size), 1, 0, self._context)
        mujoco.mjr_setBuffer(int(_WINDOW), self._context)

    def pixels(self, size: tuple[int, int]) -> Picture:
        """What was drawn last for a box of this size, as a picture: a small one, to be drawn."""
        width, height = drawn_size(*size, self._quality)
        read = np.empty((height, width, 3), np.uint8)
        mujoco.mjr_readPixels(read, None, mujoco.MjrRect(0, 0, width, height), self._context)
        small = cv2.resize(read[::-1], size, interpolation=cv2.INTER_AREA)
        return np.ascontiguousarray(small, np.uint8)

    def upload(self, texture: int) -> None:
        """The pixels of a texture of the model, which were changed."""
        mujoco.mjr_uploadTexture(self._scene.model, self._context, texture)

    def close(self) -> None:
        """Let OpenGL's memory go."""
        self._context.free()

    def _camera(self, view: str) -> mujoco.MjvCamera:
        name = self._scene.camera(view)
        if isinstance(name, mujoco.MjvCamera):
            return name
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        camera.fixedcamid = self._scene.model.camera(name).id
        return camera


class Sheet:
    """The window itself: what is written on it, over a picture or without one."""

    def __init__(self) -> None:
        model = mujoco.MjSpec().compile()
        self._context = mujoco.MjrContext(model, int(_FONT))

    def fill(self, size: tuple[int, int], colour: tuple[int, int, int], cover: float = 1.0) -> None:
        """All of it, with a colour that covers what is there by a share."""
        mujoco.mjr_setBuffer(int(_WINDOW), self._context)
        red, green, blue = (part / 255 for part in colour)
        mujoco.mjr_rectangle(mujoco.MjrRect(0, 0, *size), red, green, blue, cover)

    def put(self, picture: Picture, x: int, y: int, size: tuple[int, int]) -> None:
        """A picture with its top left at x, y, as far as it is within the window."""
        picture = picture[: max(0, size[1] - y), : max(0, size[0] - x) // 4 * 4]
        rows, columns = picture.shape[:2]
        if x < 0 or rows == 0 or columns == 0:
            return
        mujoco.mjr_setBuffer(int(_WINDOW), self._context)
        upside_down = np.ascontiguousarray(picture[::-1]).reshape(-1, 1)
        part = mujoco.MjrRect(x, size[1] - y - rows, columns, rows)
        mujoco.mjr_drawPixels(upside_down, None, part, self._context)
