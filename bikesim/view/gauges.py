"""The plates that stand over the pictures of a run: time, haptics, lean, torque.

Each is drawn in two parts: what never changes, once, and what a moment says. Lengths are in pixels
of a 720p video; `unit` is one of those in pixels of this one.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, Protocol

import cv2
import numpy as np

from bikesim.view.canvas import Canvas
from bikesim.view.drawing import (
    BOLD,
    GREEN,
    GREY,
    ORANGE,
    SKY,
    VERMILION,
    WHITE,
    Colour,
    Picture,
    dot,
    fill,
    line,
    plate,
    text_width,
    write,
)
from bikesim.view.layout import Box
from bikesim.view.reel import Moment, Reel

MARGIN = 16
_LEAN_RANGE = 45.0  # [deg], each side
_RADIUS = 10


class Gauge(Protocol):
    """Draws what it says of a moment over what a canvas has."""

    def draw(self, canvas: Canvas, moment: Moment) -> None: ...


class _Size(NamedTuple):
    width: float
    height: float


class _Plate:
    """A dark plate and what never changes on it; its top left is at x, y of the area [pixel]."""

    def __init__(
        self, area: Box, x: float, y: float, size: _Size, unit: float,
        marks: Callable[[Picture, float, float], None] | None = None,
    ) -> None:  # fmt: skip
        self._box = Box.about(x, y, *size, area)
        self.x, self.y = area.x + x - self._box.x, area.y + y - self._box.y
        pictures = []
        # On black and on white: what it adds to the light behind it, and what it leaves of that.
        for light in (0, 255):
            picture = np.full((self._box.height, self._box.width, 3), light, np.uint8)
            plate(picture, self.x, self.y, *size, _RADIUS * unit)
            if marks is not None:
                marks(picture, self.x, self.y)
            pictures.append(picture)
        self._added, self._left = pictures[0], pictures[1] - pictures[0]

    @contextmanager
    def over(self, canvas: Canvas) -> Iterator[Picture]:
        """Its part of the canvas, to draw on what changes; the plate is there already."""
        with canvas.drawing(self._box) as part:
            cv2.multiply(part, self._left, dst=part, scale=1 / 255)
            cv2.add(part, self._added, dst=part)
            yield part


class Clock:
    """Time and speed, top left."""

    def __init__(self, reel: Reel, area: Box, unit: float) -> None:
        self._unit = unit
        # As wide as it will ever be, so that it stands still.
        widest = text_width(_seconds(reel.last), text_size(32, unit), BOLD)
        size = _Size(max(100 * unit, widest) + 28 * unit, 82 * unit)
        self._plate = _Plate(area, MARGIN * unit, MARGIN * unit, size, unit)
        self._right = self._plate.x + size.width - 14 * unit

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        u, right, y = self._unit, self._right, self._plate.y
        time, speed = _seconds(moment.pose.time), f"{moment.pose.speed:.1f} m/s"
        with self._plate.over(canvas) as part:
            write(part, time, right, y + 36 * u, text_size(32, u), WHITE, BOLD, "right")
            write(part, speed, right, y + 68 * u, text_size(24, u), WHITE, align="right")


class Haptics:
    """The law, or that there is none, top right."""

    def __init__(self, reel: Reel, area: Box, unit: float) -> None:
        self._reel, self._unit = reel, unit
        width = text_width(reel.haptics, text_size(24, unit), BOLD) + 48 * unit
        x = area.width - width - MARGIN * unit
        self._plate = _Plate(area, x, MARGIN * unit, _Size(width, 44 * unit), unit, self._marks)

    def _marks(self, part: Picture, x: float, y: float) -> None:
        u, reel = self._unit, self._reel
        dot(part, x + 20 * u, y + 22 * u, 7 * u, GREEN if reel.haptics_on else VERMILION)
        write(part, reel.haptics, x + 36 * u, y + 30 * u, text_size(24, u), WHITE, BOLD)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        with self._plate.over(canvas):
            pass


class LeanDial:
    """Bottom left, as the rider sees the horizon: the needle leans as the bicycle does."""

    _SIZE, _TICKS = _Size(168, 122), (-45, -30, -15, 0, 15, 30, 45)

    def __init__(self, area: Box, unit: float) -> None:
        self._unit, self._radius = unit, 74 * unit
        size = _Size(*(unit * side for side in self._SIZE))
        y = area.height - size.height - MARGIN * unit
        self._plate = _Plate(area, MARGIN * unit, y, size, unit, self._marks)
        self._middle = self._axis(self._plate.x, self._plate.y)
        self._below = self._plate.y + size.height - 9 * unit

    def _axis(self, x: float, y: float) -> tuple[float, float]:
        return x + self._SIZE.width / 2 * self._unit, y + 88 * self._unit

    def _marks(self, part: Picture, x: float, y: float) -> None:
        u, radius, middle = self._unit, self._radius, self._axis(x, y)
        arc = [
            _on_dial(middle, radius, angle) for angle in np.linspace(-_LEAN_RANGE, _LEAN_RANGE, 31)
        ]
        line(part, np.array(arc), GREY, 2 * u)
        for angle in self._TICKS:
            inner = radius - (11 if angle == 0 else 7) * u
            ends = [_on_dial(middle, r, angle) for r in (inner, radius)]
            line(part, np.array(ends), GREY, 2 * u)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        u, middle, roll = self._unit, self._middle, math.degrees(moment.pose.roll)
        shown = max(-_LEAN_RANGE - 5, min(_LEAN_RANGE + 5, roll))
        needle = np.array([middle, _on_dial(middle, self._radius - 3 * u, shown)])
        with self._plate.over(canvas) as part:
            line(part, needle, SKY, 4 * u)
            dot(part, *middle, 5 * u, SKY)
            size = text_size(20, u)
            write(part, _lean_text(roll), middle[0], self._below, size, WHITE, align="middle")


class TorqueBar:
    """Bottom right: a bar from the middle, red at the limit, where that is in reach."""

    _SIZE = _Size(248, 88)

    def __init__(self, reel: Reel, area: Box, unit: float, scale: float) -> None:
        """`scale` [N m]: the end of the bar, where the limit is not before it."""
        self._unit, self._limit = unit, reel.torque_limit
        self._scale = scale if self._limit is None else min(self._limit, scale)
        self._span = (self._SIZE.width - 32) * unit
        size = _Size(*(unit * side for side in self._SIZE))
        x, y = (side - own - MARGIN * unit for side, own in zip(area[2:], size, strict=True))
        self._plate = _Plate(area, x, y, size, unit, self._marks)

    def _marks(self, part: Picture, x: float, y: float) -> None:
        u, left, span = self._unit, x + 16 * self._unit, self._span
        write(part, "feedback", x + 14 * u, y + 26 * u, text_size(20, u), WHITE)
        fill(part, left, y + 38 * u, span, 16 * u, (70, 75, 82))
        at_limit = self._limit is not None and math.isclose(self._scale, self._limit)
        for end in (left - 2 * u, left + span):
            fill(part, end, y + 35 * u, 2 * u, 22 * u, VERMILION if at_limit else GREY)
        size, below = text_size(16, u), y + 74 * u
        write(part, f"−{self._scale:g}", left, below, size, GREY)
        write(part, f"+{self._scale:g}", left + span, below, size, GREY, align="right")
        if self._limit is not None:
            text = f"limit {self._limit:g} N m"
            write(part, text, left + span / 2, below, size, GREY, align="middle")

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        u, x, y = self._unit, self._plate.x, self._plate.y
        value = f"{moment.feedback:+.2f} N m".replace("-", "−")
        right, middle = x + (self._SIZE.width - 14) * u, x + self._SIZE.width / 2 * u
        share = max(-1.0, min(1.0, moment.feedback / self._scale))
        length = abs(share) * self._span / 2
        with self._plate.over(canvas) as part:
            write(part, value, right, y + 26 * u, text_size(20, u), WHITE, BOLD, "right")
            if length > 0:
                start = middle - (length if share < 0 else 0)
                fill(part, start, y + 38 * u, length, 16 * u, self._colour(moment.feedback))
            fill(part, middle - u, y + 35 * u, 2 * u, 22 * u, WHITE)

    def _colour(self, torque: float) -> Colour:
        reached = self._limit is not None and abs(torque) >= 0.999 * self._limit
        return VERMILION if reached else ORANGE


def text_size(pixels: float, unit: float) -> int:
    """Of letters, still to be read where all else is small."""
    return max(7, round(pixels * unit))


def _seconds(time: float) -> str:
    return f"{time:.2f} s"


def _on_dial(middle: tuple[float, float], radius: float, degrees: float) -> tuple[float, float]:
    angle = math.radians(degrees)
    return middle[0] + radius * math.sin(angle), middle[1] - radius * math.cos(angle)


def _lean_text(roll: float) -> str:
    side = "" if abs(roll) < 0.05 else " right" if roll > 0 else " left"
    return f"lean {abs(roll):.1f}°{side}"
