"""Draws the road scene in a process of its own, with an OpenGL that works here: `pictures`.

MuJoCo chooses its OpenGL when it is imported, which in a test's process is too early.
"""

import pickle
import subprocess
import sys
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.view.gl import find_backend
from bikesim.view.pose import Pose


class Shot(NamedTuple):
    """What to draw; `path` as in `road_scene`, `segments` instead of colours."""

    pose: Pose
    view: str
    roll_cue: bool = True
    path: Any = None
    segments: bool = False
    bicycle: str = "benchmark"
    size: tuple[int, int] = (640, 360)


class Drawn(NamedTuple):
    """A picture (rows, columns, 3), or the number of the thing at each pixel with their names.

    `camera` is its place, its axes as columns, and the tangent of half its height.
    """

    pixels: NDArray[Any]
    names: dict[int, str]
    camera: tuple[NDArray[np.float64], NDArray[np.float64], float]

    def seen(self, *names: str) -> NDArray[np.bool_]:
        """Where in a picture of segments things of these names are."""
        return np.isin(self.pixels, [k for k, name in self.names.items() if name in names])

    def pixel(self, point: NDArray[np.float64]) -> tuple[float, float]:
        """Column and row at which a point of the scene appears."""
        place, axes, tangent = self.camera
        x, y, z = axes.T @ (point - place)
        rows, columns = self.pixels.shape[:2]
        scale = 0.5 * rows / tangent / -z
        return 0.5 * columns + scale * x - 0.5, 0.5 * rows - scale * y - 0.5


def pictures(shots: list[Shot]) -> list[Drawn]:
    """All of them, by one process."""
    ran = subprocess.run(
        [sys.executable, __file__],
        input=pickle.dumps([tuple(shot) for shot in shots]),
        env=find_backend().environment(threads=2),
        capture_output=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr.decode()[-2000:]
    return [Drawn(*parts) for parts in pickle.loads(ran.stdout)]


def _made(shot: Shot, made: dict[Any, Any]) -> tuple[Any, Any]:
    """The scene of a shot and its renderer, which take long to make."""
    import mujoco

    from bikesim import bicycles
    from bikesim.view.scene import road_scene

    path = None if shot.path is None else np.asarray(shot.path)
    key = (shot.bicycle, shot.roll_cue, None if path is None else path.tobytes(), shot.size)
    if key not in made:
        scene = road_scene(bicycles.load(shot.bicycle), path=path, roll_cue=shot.roll_cue)
        scene.model.vis.quality.offsamples = 0
        width, height = shot.size
        renderer = mujoco.Renderer(scene.model, height, width)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        scene.prepare(renderer.scene)
        made[key] = scene, renderer
    return made[key]


def _draw(shot: Shot, made: dict[Any, Any]) -> tuple[Any, ...]:
    scene, renderer = _made(shot, made)
    scene.show(shot.pose)
    if shot.segments:
        renderer.enable_segmentation_rendering()
    else:
        renderer.disable_segmentation_rendering()
    renderer.update_scene(scene.data, scene.camera(shot.view), scene.option(shot.view))
    pixels = renderer.render()
    names = {k: scene.model.geom(k).name for k in range(scene.model.ngeom)}
    camera = scene.data.camera(scene.camera(shot.view))
    tangent = np.tan(0.5 * np.radians(scene.model.camera(shot.view).fovy[0]))
    axes = camera.xmat.reshape(3, 3).copy()
    return (
        pixels[..., 0] if shot.segments else pixels,
        names,
        (camera.xpos.copy(), axes, float(tangent)),
    )


def _main() -> None:
    made: dict[Any, Any] = {}
    shots = [Shot(Pose(*first), *rest) for first, *rest in pickle.load(sys.stdin.buffer)]
    sys.stdout.buffer.write(pickle.dumps([_draw(shot, made) for shot in shots]))
    for _, renderer in made.values():
        renderer.close()


if __name__ == "__main__":
    _main()
