"""The scenes of one ride in a window's OpenGL, made when a view wants them."""

from typing import Protocol

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.view.bench import BenchScene
from bikesim.view.drawing import Picture
from bikesim.view.live.picture import LivePainter
from bikesim.view.pose import Pose, Values
from bikesim.view.quality import Quality
from bikesim.view.road_scene import RoadScene

Size = tuple[int, int]


class Shown(Protocol):
    """What is shown of a ride; see `road_scene`. `preview` [s] of the path are seen, None: all."""

    @property
    def bicycle(self) -> Bicycle: ...

    @property
    def path(self) -> Values | None: ...

    @property
    def roll_cue(self) -> bool: ...

    @property
    def preview(self) -> float | None: ...


class Stage:
    """Draws poses for one ride; `size` is the window's, in pixels."""

    def __init__(self, shown: Shown, size: Size, quality: Quality) -> None:
        self._shown, self._size, self._quality = shown, size, quality
        scene = RoadScene(
            shown.bicycle, path=shown.path, roll_cue=shown.roll_cue, preview=shown.preview
        )
        self._road = LivePainter(scene, size, quality)
        self._bench: tuple[BenchScene, LivePainter] | None = None

    def draw(self, view: str, pose: Pose, seen: Pose | None, size: Size) -> bool:
        """Into the window: what the rider sees, `seen`, or the bench at `pose` with that before it.

        False where the rider's display is dark and nothing was drawn.
        """
        if view in BenchScene.views:
            self._draw_bench(view, pose, seen, size)
            return True
        if seen is None:
            return False
        self._road.draw(seen, view, size)
        self._road.to_window(size)
        return True

    def close(self) -> None:
        """Let OpenGL's memory go."""
        self._road.close()
        if self._bench is not None:
            self._bench[1].close()

    def _draw_bench(self, view: str, pose: Pose, seen: Pose | None, size: Size) -> None:
        if self._bench is None:
            scene = BenchScene(self._shown.bicycle)
            self._bench = scene, LivePainter(scene, self._size, self._quality)
        scene, painter = self._bench
        painter.upload(scene.put_on_the_screen(self._before_the_rider(seen, scene.screen_size)))
        painter.draw(pose, view, size)
        painter.to_window(size)

    def _before_the_rider(self, seen: Pose | None, size: Size) -> Picture:
        if seen is None:
            return np.zeros((size[1], size[0], 3), np.uint8)
        self._road.draw(seen, "first", size)
        return self._road.pixels(size)
