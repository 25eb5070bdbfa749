"""The frames of a video: pictures, overlay and strips of each run, put together."""

import pickle

import numpy as np

from bikesim.view.drawing import INK, Picture
from bikesim.view.film import Film
from bikesim.view.layout import Column
from bikesim.view.overlay import Overlay, torque_scale
from bikesim.view.picture import Painter
from bikesim.view.reel import Reel
from bikesim.view.scene import Scene, bench_scene, road_scene
from bikesim.view.strip import Limits, Strip, limits


class Composer:
    """Makes any frame of a film; needs OpenGL, and keeps it until closed."""

    def __init__(self, film: Film) -> None:
        self._film = film
        axes = limits(film.reels)
        scale = torque_scale(film.reels)
        self._frame = np.empty((film.layout.height, film.layout.width, 3), np.uint8)
        self._studio = _Studio(film)
        self._columns = [
            _ColumnComposer(film, reel, column, self._studio, axes, scale)
            for reel, column in zip(film.reels, film.layout.columns, strict=True)
        ]

    def frame(self, number: int) -> Picture:
        """A frame as RGB; only valid until the next."""
        for column in self._columns:
            column.draw(self._frame, number)
        return self._frame

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
            self._overlay = Overlay(reel, unit, lean=film.roll_cue, torque_scale=scale)
        self._line = max(1, round(2 * unit))

    def draw(self, frame: Picture, number: int) -> None:
        moment = self._reel.moment(number)
        for (view, box), painter in zip(self._column.pictures, self._painters, strict=True):
            frame[box.part] = painter.paint(moment.pose, view)
        if self._overlay is not None:
            time = self._reel.first + float(self._elapsed[number])
            self._overlay.draw(frame[self._column.area.part], moment, time)
        if self._strip is not None and self._column.strip is not None:
            self._strip.draw(frame[self._column.strip.part], moment)
        self._draw_borders(frame)

    def _draw_borders(self, frame: Picture) -> None:
        for _, box in self._column.pictures:
            if box.x > 0:
                frame[box.y : box.y + box.height, box.x - self._line // 2 : box.x + self._line] = (
                    INK
                )
            if box.y > 0:
                frame[box.y : box.y + self._line, box.x : box.x + box.width] = INK


class _Studio:
    """The painters of a film: pictures of the same scene and size share one."""

    def __init__(self, film: Film) -> None:
        self._film = film
        self._painters: dict[tuple[bytes, bool, int, int], Painter] = {}

    def painter(self, reel: Reel, view: str, width: int, height: int) -> Painter:
        key = (pickle.dumps(reel.bicycle), view == "bench", width, height)
        if key not in self._painters:
            scene = make_scene(reel, view, roll_cue=self._film.roll_cue)
            self._painters[key] = Painter(scene, width, height, self._film.quality)
        return self._painters[key]

    def close(self) -> None:
        for painter in self._painters.values():
            painter.close()


def make_scene(reel: Reel, view: str, *, roll_cue: bool) -> Scene:
    """The scene that a view looks at."""
    if view == "bench":
        return bench_scene(reel.bicycle)
    return road_scene(reel.bicycle, roll_cue=roll_cue)
