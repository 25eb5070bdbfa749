"""The frames of a video: pictures, overlay and strips of each run, put together."""

import pickle

from bikesim.view.canvas import Canvas, Pixels, make_canvas
from bikesim.view.drawing import INK
from bikesim.view.film import Film
from bikesim.view.layout import Column
from bikesim.view.overlay import Overlay, torque_scale
from bikesim.view.picture import Painter
from bikesim.view.pose import Pose
from bikesim.view.reel import Reel
from bikesim.view.scene import Scene, bench_scene, road_scene
from bikesim.view.strip import Limits, Strip, limits


class Composer:
    """Makes any frame of a film; needs OpenGL, and keeps it until closed."""

    def __init__(self, film: Film, pixels: str) -> None:
        """`pixels`: the format of the frames, "rgb24" or "yuv420p"."""
        axes = limits(film.reels)
        scale = torque_scale(film.reels)
        self._canvas = make_canvas(pixels, film.layout.width, film.layout.height)
        self._studio = _Studio(film)
        self._columns = [
            _ColumnComposer(film, reel, column, self._studio, axes, scale)
            for reel, column in zip(film.reels, film.layout.columns, strict=True)
        ]

    def frame(self, number: int) -> Pixels:
        """A frame; only valid until the next."""
        for column in self._columns:
            column.draw(self._canvas, number)
        return self._canvas.pixels

    def close(self) -> None:
        """Let OpenGL go."""
        self._studio.close()


class _ColumnComposer:
    def __init__(
        self, film: Film, reel: Reel, column: Column, studio: "_Studio", axes: Limits, scale: float
    ) -> None:
        self._reel, self._column, self._elapsed = reel, column, film.elapsed
        unit = film.layout.unit
        self._painters = [
            studio.painter(reel, view, box.width, box.height) for view, box in column.pictures
        ]
        self._strip = None
        if column.strip is not None:
            self._strip = Strip(reel.curves, axes, column.strip.width, column.strip.height, unit)
        self._overlay = None
        if film.overlay:
            self._overlay = Overlay(reel, column.area, unit, lean=reel.roll_cue, torque_scale=scale)
        self._line = 2 * max(1, round(unit))
        self._drawn: tuple[Pose, bool] | None = None

    def draw(self, canvas: Canvas, number: int) -> None:
        moment = self._reel.moment(number)
        time = self._reel.first + float(self._elapsed[number])
        shown = (moment.pose, self._reel.ended(time))
        if shown == self._drawn:  # a run that ended before another one stands still
            return
        self._drawn = shown
        for (view, box), painter in zip(self._column.pictures, self._painters, strict=True):
            canvas.put(box, painter.paint(moment.pose, view))
        self._draw_borders(canvas)
        if self._overlay is not None:
            self._overlay.draw(canvas, moment, time)
        if self._strip is not None and self._column.strip is not None:
            with canvas.drawing(self._column.strip) as part:
                self._strip.draw(part, moment)

    def _draw_borders(self, canvas: Canvas) -> None:
        for _, box in self._column.pictures:
            if box.x > 0:
                canvas.fill(box._replace(width=self._line), INK)
            if box.y > 0:
                canvas.fill(box._replace(height=self._line), INK)


class _Studio:
    """The painters of a film: pictures of the same scene and size share one."""

    def __init__(self, film: Film) -> None:
        self._film = film
        self._painters: dict[tuple[bytes, int, int], Painter] = {}

    def painter(self, reel: Reel, view: str, width: int, height: int) -> Painter:
        shown = (reel.bicycle, reel.path, reel.roll_cue, view == "bench")
        key = (pickle.dumps(shown), width, height)
        if key not in self._painters:
            scene = make_scene(reel, view)
            self._painters[key] = Painter(scene, width, height, self._film.quality)
        return self._painters[key]

    def close(self) -> None:
        for painter in self._painters.values():
            painter.close()


def make_scene(reel: Reel, view: str) -> Scene:
    """The scene that a view looks at."""
    if view == "bench":
        return bench_scene(reel.bicycle)
    return road_scene(reel.bicycle, path=reel.path, roll_cue=reel.roll_cue)
