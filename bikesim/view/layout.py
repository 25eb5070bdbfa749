"""Where the pictures and the strips of a video lie in its frames."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from bikesim.errors import InputError, unknown

VIEWS = ("first", "second", "bench")
BOTH = "both"
MOST_RUNS = 4
_SMALLEST = (160, 90)
_STRIP_BESIDE, _STRIP_STACKED = 0.27, 0.40  # of the height of a frame


class Box(NamedTuple):
    """A part of a frame, in pixels from its top left."""

    x: int
    y: int
    width: int
    height: int

    @classmethod
    def about(cls, x: float, y: float, width: float, height: float, within: "Box") -> "Box":
        """The smallest box with even edges about a rectangle, as far as it is `within` another."""
        left, top = (2 * math.floor(max(0.0, at) / 2) for at in (x, y))
        right, bottom = (2 * math.ceil(end / 2) for end in (x + width, y + height))
        right, bottom = min(right, within.width), min(bottom, within.height)
        width, height = max(0, right - left), max(0, bottom - top)
        return cls(within.x + left, within.y + top, width, height)

    @property
    def part(self) -> tuple[slice, slice]:
        """To index a picture with."""
        return slice(self.y, self.y + self.height), slice(self.x, self.x + self.width)


class Column(NamedTuple):
    """What belongs to one run: its pictures by view, all of them as one area, and its strip."""

    pictures: tuple[tuple[str, Box], ...]
    area: Box
    strip: Box | None


@dataclass(frozen=True)
class Layout:
    """Frames of a size in pixels with one column a run."""

    width: int
    height: int
    columns: tuple[Column, ...]

    @property
    def unit(self) -> float:
        """A pixel of a 720p video in pixels of this one; columns that are narrow have less."""
        narrowest = min(column.area.width for column in self.columns)
        return min(self.height / 720, narrowest / 600)


def make_layout(
    view: str | None, runs: int, width: int, height: int, *, strip: bool = True
) -> Layout:
    """The layout of a view. None is both views of one run, and the second of several.

    One run's two views stand side by side, those of several above each other; over a `strip` of
    signals, unless it is not wanted. Raises InputError.
    """
    if width < _SMALLEST[0] or height < _SMALLEST[1]:
        raise InputError(f"--size {width}x{height}: at least {_SMALLEST[0]}x{_SMALLEST[1]} pixels")
    if not 1 <= runs <= MOST_RUNS:
        raise InputError(f"render: name from one to {MOST_RUNS} records, not {runs}")
    views = _views(view, runs)
    under = _strip_height(view, runs, width, height) if strip else 0
    columns = []
    for left, right in pairwise(_edges(0, width, runs)):
        area = Box(left, 0, right - left, height - under)
        signals = Box(left, height - under, right - left, under) if under else None
        columns.append(Column(_pictures(views, area, beside=runs == 1), area, signals))
    return Layout(width, height, tuple(columns))


def _edges(start: int, length: int, parts: int) -> list[int]:
    """Of a length cut into about equal parts; even between them, as 4:2:0 wants it."""
    between = [start + 2 * (i * length // (2 * parts)) for i in range(parts)]
    return [*between, start + length]


def _views(view: str | None, runs: int) -> tuple[str, ...]:
    if view is None:
        view = BOTH if runs == 1 else "second"
    if view == BOTH:
        return ("first", "second")
    if view not in VIEWS:
        raise unknown("--view", view, (*VIEWS, BOTH))
    return (view,)


def _strip_height(view: str | None, runs: int, width: int, height: int) -> int:
    if runs == 1 and view not in (None, BOTH):
        return 0
    share = _STRIP_BESIDE if width / runs > 4.5 * _STRIP_BESIDE * height else _STRIP_STACKED
    return 2 * round(share * height / 2)


def _pictures(views: tuple[str, ...], area: Box, *, beside: bool) -> tuple[tuple[str, Box], ...]:
    n = len(views)
    if beside:
        edges = _edges(area.x, area.width, n)
        boxes = [Box(a, area.y, b - a, area.height) for a, b in pairwise(edges)]
    else:
        edges = _edges(area.y, area.height, n)
        boxes = [Box(area.x, a, area.width, b - a) for a, b in pairwise(edges)]
    return tuple(zip(views, boxes, strict=True))
