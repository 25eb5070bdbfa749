"""The prescribed path: where it runs, and where a bicycle is beside it.

A path is known at equal distances along it, by place, heading, curvature and the integral of the
heading. Between two of these each is the cubic that keeps values and slopes at both (the
curvature: a straight line), so that all are smooth, and floats and arrays give the same to the
last bit: only sums and products.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

# A float for one bicycle; for a batch, an array with a value for each.
Real: TypeAlias = Any
Array: TypeAlias = NDArray[np.float64]

REACH = 2.0  # m, how far a place may lie from the one before it
_LEAST = 0.2  # of 1 - κ d, which is zero in the centre of curvature


class Place(NamedTuple):
    """Where a point is beside a path: the path's nearest point and how far it is from there.

    `station` [m] along the path, `deviation` [m] from it (> 0: right of the path), `heading` of
    the path there [rad]. Floats, or arrays.
    """

    station: Real
    deviation: Real
    heading: Real


@dataclass(frozen=True, eq=False)
class Path:
    """A path from the origin, x forward and y right [m]; heading [rad] > 0 turns right.

    Stations [m] count along the path from the origin. It goes on straight before its begin and,
    unless `closed`, beyond its `length` [m] (0 of the straight line). A closed path comes back to
    its station `loop`; station and heading go on growing from lap to lap.
    """

    length: float
    loop: float | None
    _step: float
    # A column for each interval, one before and one after them: the station where it begins, then
    # coefficients by powers of what is left of the station.
    _line: Array  # (13, columns): of x, y, heading
    _more: Array  # (7, columns): of the integral of the heading, and of the curvature
    _lap_heading: float
    _lap_lateral: float

    @property
    def straight(self) -> bool:
        """Whether it is the straight line along +x."""
        return not self.length

    @property
    def closed(self) -> bool:
        """Whether it comes back to where it has been."""
        return self.loop is not None

    def place(self, x: Real, y: Real, near: Real) -> Place:
        """The place of (x, y) [m] beside the path, sought from the station `near` [m].

        `near` is the station of a moment before: what is found lies within REACH of it, on the
        same branch where the path crosses itself. Two steps of Newton's method.
        """
        if self.straight:
            return Place(x, y, np.zeros(np.shape(x)) if isinstance(x, np.ndarray) else 0.0)
        many = isinstance(x, np.ndarray) or isinstance(near, np.ndarray)
        find, most, least = _ARRAYS if many else _FLOATS
        columns: Any = self._line if many else self._line_list
        station, deviation, heading = near + np.zeros(np.shape(x)) if many else near, 0.0, 0.0
        for _ in range(2):
            column, rest, laps = find(self, station)
            (
                begin, x0, x1, x2, x3, y0, y1, y2, y3, h0, h1, h2, h3,
            ) = columns.take(column, axis=1) if many else columns[column]  # fmt: skip
            t = rest - begin
            dx = x - (x0 + t * (x1 + t * (x2 + t * x3)))
            dy = y - (y0 + t * (y1 + t * (y2 + t * y3)))
            tx = x1 + t * (2.0 * x2 + 3.0 * t * x3)
            ty = y1 + t * (2.0 * y2 + 3.0 * t * y3)
            bend = dx * (2.0 * x2 + 6.0 * t * x3) + dy * (2.0 * y2 + 6.0 * t * y3)
            ahead = (dx * tx + dy * ty) / most(1.0 - bend, _LEAST)
            ahead = least(most(ahead, -0.5 * REACH), 0.5 * REACH)
            station = station + ahead
            deviation = tx * dy - ty * dx
            heading = laps * self._lap_heading + (h0 + t * (h1 + t * (h2 + t * h3)))
            heading = heading + ahead * (h1 + t * (2.0 * h2 + 3.0 * t * h3))
        return Place(station, deviation, heading)

    def point(self, station: Real) -> tuple[Real, Real]:
        """x, y [m] of the path."""
        (begin, x0, x1, x2, x3, y0, y1, y2, y3, *_), rest, _ = self._part(station, self._line)
        t = rest - begin
        return x0 + t * (x1 + t * (x2 + t * x3)), y0 + t * (y1 + t * (y2 + t * y3))

    def heading(self, station: Real) -> Real:
        """Of the path [rad]; whole turns count."""
        (begin, *_, h0, h1, h2, h3), rest, laps = self._part(station, self._line)
        t = rest - begin
        return laps * self._lap_heading + (h0 + t * (h1 + t * (h2 + t * h3)))

    def curvature(self, station: Real) -> Real:
        """Change of heading by station [1/m]."""
        (begin, *_, k0, k1), rest, _ = self._part(station, self._more)
        return k0 + (rest - begin) * k1

    def lateral(self, station: Real) -> Real:
        """The integral of the heading over the station [m].

        For small headings it is the path's y: the lateral coordinate of linear models.
        """
        (begin, l0, l1, l2, l3, *_), rest, laps = self._part(station, self._more)
        t = rest - begin
        once = l0 + t * (l1 + t * (l2 + t * l3))
        if self.loop is None:
            return once
        lap = self.length - self.loop
        before = self._lap_lateral + self._lap_heading * (
            0.5 * lap * (laps - 1) + (rest - self.loop)
        )
        return once + laps * before

    def _part(self, station: Real, table: Array) -> tuple[Any, Real, Real]:
        if isinstance(station, np.ndarray):
            column, rest, laps = _find_many(self, station)
            return table.take(column, axis=1), rest, laps
        column, rest, laps = _find(self, station)
        return (self._line_list if table is self._line else self._more_list)[column], rest, laps

    # Python's own floats are several times as fast as single elements of an array.
    @cached_property
    def _line_list(self) -> list[tuple[float, ...]]:
        return [tuple(column) for column in self._line.T.tolist()]

    @cached_property
    def _more_list(self) -> list[tuple[float, ...]]:
        return [tuple(column) for column in self._more.T.tolist()]


def path_points(path: Path, begin: float, end: float, apart: float = 0.25) -> Array:
    """Points (n, 2) [m] of the path from station `begin` to `end`, `apart` [m] or a bit less."""
    count = max(1, int(np.ceil((end - begin) / apart)))
    return np.stack(path.point(np.linspace(begin, end, count + 1)), axis=1)


def _find(path: Path, station: float) -> tuple[int, float, float]:
    """The column of a station, the station within the first lap, and the laps before it."""
    length, laps = path.length, 0.0
    if not 0.0 <= station < length:
        loop = path.loop
        if loop is not None and (station >= length or (loop == 0.0 and station < 0.0)):
            lap = length - loop
            laps = (station - loop) / lap // 1.0
            laps = laps if -1e9 < laps < 1e9 else 0.0
            station = station - laps * lap
        if not station >= 0.0:
            return 0, station, laps
        if station >= length:
            return -1, station, laps
    return min(int(station / path._step) + 1, path._line.shape[1] - 2), station, laps


def _find_many(path: Path, station: Array) -> tuple[NDArray[np.int_], Array, Array]:
    length, loop, laps = path.length, path.loop, np.zeros(station.shape)
    last = path._line.shape[1] - 1
    if loop is not None:
        lap = length - loop
        around = (station >= length) | (station < 0.0 if loop == 0.0 else False)
        laps = np.where(around, (station - loop) / lap // 1.0, 0.0)
        laps = np.where(np.abs(laps) < 1e9, laps, 0.0)
        station = station - laps * lap
    steps = np.fmax(np.fmin(station / path._step, last), 0.0)
    column = np.minimum(steps.astype(int) + 1, last - 1)
    column = np.where(station >= length, last, column)
    return np.where(station >= 0.0, column, 0), station, laps


_FLOATS: tuple[Callable[..., Any], ...] = (_find, max, min)
_ARRAYS: tuple[Callable[..., Any], ...] = (_find_many, np.maximum, np.minimum)


def straight_path() -> Path:
    """The line along +x."""
    nothing = np.zeros(1)
    return path_through(nothing, nothing, nothing, nothing, step=1.0)


def path_through(
    x: Array, y: Array, heading: Array, curvature: Array, *, step: float, loop: float | None = None
) -> Path:
    """The path through points [m] a `step` [m] apart along it, from station 0, with their heading
    [rad] and curvature [1/m]; coming back, from its last point, to the station `loop` [m].
    """
    length = step * (len(x) - 1)
    # The corrected trapezium: exact for cubics.
    parts = 0.5 * step * (heading[1:] + heading[:-1]) - step * step / 12 * np.diff(curvature)
    lateral = np.concatenate([[0.0], np.cumsum(parts)])
    begin = np.concatenate([[0.0], step * np.arange(len(x) - 1), [length]])
    flat = np.zeros(1)
    line = np.vstack(
        [
            begin,
            _cubics(x, np.cos(heading), step),
            _cubics(y, np.sin(heading), step),
            _cubics(heading, curvature, step, ends=0.0),
        ]
    )
    more = np.vstack(
        [
            begin,
            _cubics(lateral, heading, step),
            np.concatenate([flat, curvature[:-1], flat]),
            np.concatenate([flat, np.diff(curvature) / step, flat]),
        ]
    )
    line.flags.writeable = more.flags.writeable = False
    path = Path(length, None, step, line, more, 0.0, 0.0)
    if loop is None:
        return path
    turn, drift = heading[-1] - path.heading(loop), lateral[-1] - path.lateral(loop)
    return replace(path, loop=loop, _lap_heading=float(turn), _lap_lateral=float(drift))


def _cubics(values: Array, slopes: Array, step: float, ends: float = 1.0) -> Array:
    """Coefficients (4, columns) by powers; straight, with `ends` of the slope, before and after."""
    rise, before, after = np.diff(values), slopes[:-1], slopes[1:]
    inner = np.vstack(
        [
            values[:-1],
            before,
            (3 * rise - step * (2 * before + after)) / step**2,
            (step * (before + after) - 2 * rise) / step**3,
        ]
    )
    first, last = ([[values[i]], [ends * slopes[i]], [0.0], [0.0]] for i in (0, -1))
    return np.hstack([first, inner, last])
