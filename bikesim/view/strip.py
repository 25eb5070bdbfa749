"""The strip of signals under the pictures, growing with time: Figure 5 alive."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.view.drawing import (
    BOLD,
    DARK,
    GREY,
    INK,
    ORANGE,
    SKY,
    VERMILION,
    WHITE,
    Colour,
    Picture,
    dot,
    fill,
    line,
    text_width,
    write,
)
from bikesim.view.reel import WINDOW_SECONDS, Curves, Moment, Reel

# Of a fall: it leaves the chart rather than flatten what came before it [s].
_FALLING = 1.0


class Limits(NamedTuple):
    """The ends of the axes: angle [deg], torque [N m], and the time shown at once [s]."""

    angle: float
    torque: float
    window: float


def limits(reels: Sequence[Reel]) -> Limits:
    """Axes that hold the curves of all these runs, but for the second before a fall."""
    curves = [_before_fall(reel) for reel in reels]
    angles = [np.abs(c).max() for curve in curves for c in (curve.roll, curve.steer)]
    torques = [np.abs(c).max() for curve in curves for c in (curve.feedback, curve.rider) if len(c)]
    duration = max(reel.last - reel.first for reel in reels)
    return Limits(
        nice(max(1.0, *angles)),
        nice(max(0.1, *torques)),
        max(1e-3, min(duration, WINDOW_SECONDS)),
    )


def _before_fall(reel: Reel) -> Curves:
    until = reel.curves.until(reel.last - _FALLING) if reel.fell else 0
    return Curves(*(values[: until or None] for values in reel.curves))


def nice(value: float) -> float:
    """The next round number at or above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(
        step * power for step in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if value <= step * power * 1.0001
    )


class _Signal(NamedTuple):
    name: str
    colour: Colour
    values: NDArray[np.float64]


class _Panel:
    """One pair of axes with its curves.

    The curves lie on a ribbon as long as the run, of which a frame shows the columns up to now. It
    is drawn piece by piece, each once, so that a frame costs the same however long the run is.
    """

    def __init__(
        self, title: str, signals: list[_Signal], limit: float, area: tuple[int, int, int, int]
    ) -> None:
        self.title, self.signals, self.limit = title, signals, limit
        self.x, self.y, self.width, self.height = area
        self._pieces: dict[int, Picture] = {}

    def row(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels below the area's top."""
        return (1 - value / self.limit) * (self.height - 1) / 2

    def show(self, frame: Picture, ribbon: "_Ribbon", first: int, last: int) -> None:
        """The ribbon's columns from `first` to before `last` at the left of the area."""
        while first < last:
            number, offset = divmod(first, self.width)
            count = min(last - first, self.width - offset)
            piece = self._piece(number, ribbon)
            x = self.x + first - ribbon.shown_from
            frame[self.y : self.y + self.height, x : x + count] = piece[:, offset : offset + count]
            first += count

    def _piece(self, number: int, ribbon: "_Ribbon") -> Picture:
        if number not in self._pieces:
            while len(self._pieces) > 1:
                self._pieces.pop(next(iter(self._pieces)))
            self._pieces[number] = self._draw_piece(number, ribbon)
        return self._pieces[number]

    def _draw_piece(self, number: int, ribbon: "_Ribbon") -> Picture:
        piece = np.empty((self.height, self.width, 3), np.uint8)
        piece[:] = INK
        self.draw_grid(piece, 0, 0, ribbon.unit)
        columns = ribbon.columns - number * self.width
        near = slice(*np.searchsorted(columns, (-8, self.width + 8)))
        for signal in self.signals:
            points = np.stack([columns[near], self.row(signal.values[near])], axis=1)
            line(piece, points, signal.colour, 1.7 * ribbon.unit)
        return piece

    def draw_grid(self, picture: Picture, x: int, y: int, unit: float) -> None:
        """Lines at zero and at the ends; the area's top left is at x, y."""
        thin = max(1, round(unit))
        for value in (-self.limit, self.limit, 0.0):
            row = y + round(float(self.row(np.array(value))))
            row = min(row, y + self.height - thin)
            picture[row : row + thin, x : x + self.width] = DARK if value else GREY


class _Ribbon:
    """The time axis of the curves: `columns` is where their points lie [pixel]."""

    def __init__(self, curves: Curves, window: float, width: int, unit: float) -> None:
        self.unit = unit
        self._first, self._window, self._width = float(curves.time[0]), window, width
        self.per_second = (width - 1) / window
        self.columns = (curves.time - self._first) * self.per_second
        self.shown_from = 0

    def scroll(self, time: float) -> float:
        """Shows what is up to a time [s], as long as there is room from the begin of the run on.

        Gives the column of that time.
        """
        now = (time - self._first) * self.per_second
        self.shown_from = max(0, round(now) - (self._width - 1))
        return now

    @property
    def start(self) -> float:
        """The time at the left [s]."""
        return self._first + self.shown_from / self.per_second


class Strip:
    """Draws the signals of a run up to a time into a part of a frame."""

    def __init__(self, curves: Curves, axes: Limits, width: int, height: int, unit: float) -> None:
        """`unit` is a pixel of a 720p video in pixels of this one."""
        self._window, self._unit = axes.window, unit
        self._panels = _panels(curves, axes, width, height, unit)
        self._ribbon = _Ribbon(curves, axes.window, self._panels[0].width, unit)
        self._empty = self._background(width, height)

    def draw(self, frame: Picture, moment: Moment) -> None:
        """Fill a part of a frame of the strip's size."""
        frame[:] = self._empty
        ribbon, heads = self._ribbon, _heads(moment)
        now = ribbon.scroll(moment.pose.time)
        for panel in self._panels:
            panel.show(frame, ribbon, ribbon.shown_from, round(now) + 1)
            for signal in panel.signals:
                row = float(panel.row(np.array(heads[signal.name])))
                if 0 <= row < panel.height:
                    x = panel.x + now - ribbon.shown_from
                    dot(frame, x, panel.y + row, 4.5 * self._unit, signal.colour)
            self._write_time(frame, panel)

    def _background(self, width: int, height: int) -> Picture:
        frame = np.empty((height, width, 3), np.uint8)
        frame[:] = INK
        for panel in self._panels:
            panel.draw_grid(frame, panel.x, panel.y, self._unit)
            self._write_axes(frame, panel)
        return frame

    def _write_axes(self, frame: Picture, panel: _Panel) -> None:
        unit = self._unit
        size = max(7, round(16 * unit))
        for value in (-panel.limit, 0.0, panel.limit):
            row = panel.y + float(panel.row(np.array(value)))
            text = f"{value:+g}".replace("-", "−") if value else "0"
            write(frame, text, panel.x - 8 * unit, row + 0.36 * size, size, GREY, align="right")
        above = panel.y - 9 * unit
        write(frame, panel.title, panel.x, above, size, GREY)
        x = float(panel.x + panel.width)
        for signal in reversed(panel.signals):
            write(frame, signal.name, x, above, size, signal.colour, BOLD, "right")
            x -= text_width(signal.name, size, BOLD) + 20 * unit

    def _write_time(self, frame: Picture, panel: _Panel) -> None:
        """The time axis, which moves once a run is longer than what is shown at once."""
        unit, start, window = self._unit, self._ribbon.start, self._window
        size = max(7, round(15 * unit))
        y = panel.y + panel.height
        step = nice_step(window * 80 * unit / panel.width)
        # The end of a run may be a tick before a round number.
        last = math.floor((start + 1.005 * window) / step)
        for k in range(math.ceil(start / step - 1e-9), last + 1):
            x = panel.x + (k * step - start) * self._ribbon.per_second
            fill(frame, x - 0.5, y, max(1, round(unit)), 4 * unit, GREY)
            text = f"{k * step:g}" + (" s" if k == last else "")
            write(frame, text, x, y + 5 * unit + size, size, GREY, align="middle")


def _heads(moment: Moment) -> dict[str, float]:
    return {
        "roll φ": math.degrees(moment.pose.roll),
        "steer δ": math.degrees(moment.pose.steer),
        "feedback torque": moment.feedback,
        "rider torque": moment.rider,
    }


def nice_step(value: float) -> float:
    """1, 2 or 5 times a power of ten, at or above a value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 2, 5, 10) if value <= step * power * 1.0001)


def _panels(curves: Curves, axes: Limits, width: int, height: int, unit: float) -> list[_Panel]:
    angles = [_Signal("roll φ", SKY, curves.roll), _Signal("steer δ", VERMILION, curves.steer)]
    torques = [_Signal("feedback torque", WHITE, curves.feedback)]
    if len(curves.rider):
        torques.insert(0, _Signal("rider torque", ORANGE, curves.rider))
    left, right, top, bottom = (round(size * unit) for size in (58, 26, 34, 30))
    shown = [("angle [deg]", angles, axes.angle), ("torque [N m]", torques, axes.torque)]
    if beside(width, height):
        areas = [
            (i * (width // 2) + left, top, width // 2 - left - right, height - top - bottom)
            for i in (0, 1)
        ]
    else:
        areas = [
            (left, i * (height // 2) + top, width - left - right, height // 2 - top - bottom)
            for i in (0, 1)
        ]
    return [_Panel(*what, area) for what, area in zip(shown, areas, strict=True)]


def beside(width: int, height: int) -> bool:
    """Whether angles and torques stand side by side, not one above the other."""
    return width > 4.5 * height
