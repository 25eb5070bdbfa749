"""What is written over the pictures of a run: time, speed, haptics, lean, torque, the fall."""

import math
from collections.abc import Sequence

import cv2
import numpy as np

from bikesim.view.drawing import (
    BOLD,
    GREEN,
    GREY,
    ORANGE,
    REGULAR,
    SKY,
    VERMILION,
    WHITE,
    Colour,
    Picture,
    darken,
    dot,
    fill,
    line,
    plate,
    text_width,
    write,
)
from bikesim.view.reel import Moment, Reel
from bikesim.view.strip import nice

_MARGIN = 16  # all lengths in pixels of a 720p video
_LEAN_RANGE = 45.0  # [deg], each side
_ENDED_LIGHT = 0.55


class Overlay:
    """Draws over the pictures of one run; `unit` is a pixel of a 720p video in those of this."""

    def __init__(self, reel: Reel, unit: float, *, lean: bool, torque_scale: float) -> None:
        """`lean`: whether the lean indicator is shown; `torque_scale` [N m]: end of the bar."""
        self._reel, self._unit, self._lean = reel, unit, lean
        limit = reel.torque_limit
        self._scale = torque_scale if limit is None else min(limit, torque_scale)

    def draw(self, area: Picture, moment: Moment, time: float) -> None:
        """Over the pictures of the run at a time of the video [s], which may be past its end."""
        ended = self._reel.ended(time)
        if ended:
            darken(area, _ENDED_LIGHT)
        self._draw_time(area, moment)
        self._draw_haptics(area)
        if self._lean:
            self._draw_lean(area, math.degrees(moment.pose.roll))
        self._draw_torque(area, moment.feedback)
        if ended:
            self._draw_ending(area)

    def _draw_time(self, area: Picture, moment: Moment) -> None:
        u = self._unit
        x = y = _MARGIN * u
        size = _size(32, u)
        # As wide as it will ever be, so that it stands still.
        width = max(100 * u, text_width(_seconds(self._reel.last), size, BOLD)) + 28 * u
        plate(area, x, y, width, 82 * u, 10 * u)
        right = x + width - 14 * u
        write(area, _seconds(moment.pose.time), right, y + 36 * u, size, WHITE, BOLD, "right")
        speed = f"{moment.pose.speed:.1f} m/s"
        write(area, speed, right, y + 68 * u, _size(24, u), WHITE, align="right")

    def _draw_haptics(self, area: Picture) -> None:
        u, text = self._unit, self._reel.haptics
        size = _size(24, u)
        width = text_width(text, size, BOLD) + 48 * u
        x, y = area.shape[1] - width - _MARGIN * u, _MARGIN * u
        plate(area, x, y, width, 44 * u, 10 * u)
        dot(area, x + 20 * u, y + 22 * u, 7 * u, GREEN if self._reel.haptics_on else VERMILION)
        write(area, text, x + 36 * u, y + 30 * u, size, WHITE, BOLD)

    def _draw_lean(self, area: Picture, roll: float) -> None:
        """A dial seen as the rider sees the horizon: the needle leans as the bicycle does."""
        u = self._unit
        width, height, radius = 168 * u, 122 * u, 74 * u
        x, y = _MARGIN * u, area.shape[0] - height - _MARGIN * u
        plate(area, x, y, width, height, 10 * u)
        cx, cy = x + width / 2, y + 88 * u
        arc = [
            _on_dial(cx, cy, radius, angle) for angle in np.linspace(-_LEAN_RANGE, _LEAN_RANGE, 31)
        ]
        line(area, np.array(arc), GREY, 2 * u)
        for angle in (-45, -30, -15, 0, 15, 30, 45):
            inner = radius - (11 if angle == 0 else 7) * u
            ends = [_on_dial(cx, cy, r, angle) for r in (inner, radius)]
            line(area, np.array(ends), GREY, 2 * u)
        shown = max(-_LEAN_RANGE - 5, min(_LEAN_RANGE + 5, roll))
        needle = [(cx, cy), _on_dial(cx, cy, radius - 3 * u, shown)]
        line(area, np.array(needle), SKY, 4 * u)
        dot(area, cx, cy, 5 * u, SKY)
        write(area, _lean_text(roll), cx, y + height - 9 * u, _size(20, u), WHITE, align="middle")

    def _draw_torque(self, area: Picture, torque: float) -> None:
        """A bar from the middle; its ends are the limit, and red, where that is in reach."""
        u = self._unit
        width, height = 248 * u, 88 * u
        x, y = area.shape[1] - width - _MARGIN * u, area.shape[0] - height - _MARGIN * u
        plate(area, x, y, width, height, 10 * u)
        size = _size(20, u)
        write(area, "feedback", x + 14 * u, y + 26 * u, size, WHITE)
        value = f"{torque:+.2f} N m".replace("-", "−")
        write(area, value, x + width - 14 * u, y + 26 * u, size, WHITE, BOLD, "right")
        left, span, top = x + 16 * u, width - 32 * u, y + 38 * u
        fill(area, left, top, span, 16 * u, (70, 75, 82))
        share = max(-1.0, min(1.0, torque / self._scale))
        length = abs(share) * span / 2
        start = left + span / 2 - (length if share < 0 else 0)
        if length > 0:
            fill(area, start, top, length, 16 * u, self._bar_colour(torque))
        fill(area, left + span / 2 - u, top - 3 * u, 2 * u, 22 * u, WHITE)
        self._draw_scale(area, left, span, top + 16 * u)

    def _draw_scale(self, area: Picture, left: float, span: float, below: float) -> None:
        u, limit = self._unit, self._reel.torque_limit
        size = _size(16, u)
        at_limit = limit is not None and math.isclose(self._scale, limit)
        colour: Colour = VERMILION if at_limit else GREY
        for end in (left - 2 * u, left + span):
            fill(area, end, below - 19 * u, 2 * u, 22 * u, colour)
        y = below + 20 * u
        write(area, f"−{self._scale:g}", left, y, size, GREY, REGULAR)
        write(area, f"+{self._scale:g}", left + span, y, size, GREY, REGULAR, "right")
        if limit is not None:
            write(area, f"limit {limit:g} N m", left + span / 2, y, size, GREY, align="middle")

    def _bar_colour(self, torque: float) -> Colour:
        limit = self._reel.torque_limit
        reached = limit is not None and abs(torque) >= 0.999 * limit
        return VERMILION if reached else ORANGE

    def _draw_ending(self, area: Picture) -> None:
        u, text = self._unit, self._reel.end_text
        size = _size(46, u)
        width, height = text_width(text, size, BOLD) + 56 * u, 78 * u
        x, y = (area.shape[1] - width) / 2, area.shape[0] * 0.34 - height / 2
        left, top = max(0, round(x)), max(0, round(y))
        cv2.rectangle(area, (left, top), (round(x + width), round(y + height)), (196, 70, 20), -1)
        write(area, text, area.shape[1] / 2, y + 55 * u, size, WHITE, BOLD, "middle")


def torque_scale(reels: Sequence[Reel]) -> float:
    """A round end of the torque bar that all these runs stay within [N m]."""
    return nice(max(0.5, *(1.1 * float(np.abs(reel.curves.feedback).max()) for reel in reels)))


def _size(pixels: float, unit: float) -> int:
    return max(7, round(pixels * unit))


def _seconds(time: float) -> str:
    return f"{time:.2f} s"


def _on_dial(cx: float, cy: float, radius: float, degrees: float) -> tuple[float, float]:
    angle = math.radians(degrees)
    return cx + radius * math.sin(angle), cy - radius * math.cos(angle)


def _lean_text(roll: float) -> str:
    side = "" if abs(roll) < 0.05 else " right" if roll > 0 else " left"
    return f"lean {abs(roll):.1f}°{side}"
