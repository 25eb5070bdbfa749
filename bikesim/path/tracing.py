"""From a curve to a path: equal distances along it, heading and curvature there."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bikesim.errors import InputError
from bikesim.path.path import Array, Path, path_through

STEP = 0.1  # m, at most, between two stations
LEAST_LENGTH = 5.0  # m
LEAST_RADIUS = 2.0  # m; a bicycle's front wheel stands at 30 degrees there
_LONGEST = 20e3  # m
# Gauss and Legendre, three points on 0 to 1.
_AT = 0.5 + np.array([-0.5, 0.0, 0.5]) * np.sqrt(0.6)
_WEIGHT = np.array([5.0, 8.0, 5.0]) / 18


class Trace(NamedTuple):
    """A curve at values (n,) of its parameter: place [m], and first and second derivatives."""

    x: Array
    y: Array
    dx: Array
    dy: Array
    ddx: Array
    ddy: Array


class Curve(NamedTuple):
    """A smooth curve over the parameter from 0 to `end`, of about a metre a unit.

    It sets out from the origin along +x. `loop` is the parameter that it comes back to at its
    end, None if it does not.
    """

    at: Callable[[Array], Trace]
    end: float
    loop: float | None = None


def traced(curve: Curve) -> Path:
    """The path along a curve. Raises InputError if it is too short or bends too much."""
    knots = np.linspace(0.0, curve.end, max(2, int(np.ceil(curve.end / STEP)) + 1))
    along = np.concatenate([[0.0], np.cumsum(_lengths(curve, knots[:-1], knots[1:]))])
    length = float(along[-1])
    _check_length(length)
    count = int(np.ceil(length / STEP))
    step = length / count
    station: Array = step * np.arange(count + 1.0)
    at = curve.at(_parameters(curve, knots, along, station))
    heading = np.unwrap(np.arctan2(at.dy, at.dx))
    curvature = (at.dx * at.ddy - at.dy * at.ddx) / np.hypot(at.dx, at.dy) ** 3
    check_bends(station, curvature)
    loop = None
    if curve.loop is not None:
        loop = float(np.interp(curve.loop, knots, along))
    return path_through(at.x, at.y, heading, curvature, step=step, loop=loop)


def _lengths(curve: Curve, begin: Array, end: Array) -> Array:
    """Along the curve, from each parameter to the other."""
    wide = end - begin
    at = curve.at((begin[:, None] + wide[:, None] * _AT).ravel())
    speeds: Array = np.hypot(at.dx, at.dy).reshape(-1, 3)
    return wide * (speeds @ _WEIGHT)


def _parameters(curve: Curve, knots: Array, along: Array, station: Array) -> Array:
    """Of the stations, by Newton's method."""
    u = np.interp(station, along, knots)
    for _ in range(3):
        i = np.clip(np.searchsorted(knots, u, side="right") - 1, 0, len(knots) - 2)
        at = curve.at(u)
        u = u - (along[i] + _lengths(curve, knots[i], u) - station) / np.hypot(at.dx, at.dy)
        u = np.clip(u, 0.0, curve.end)
    return u


def by_curvature(curvature: Array, heading: Array, step: float, *, loop: float | None) -> Path:
    """The path that sets out along +x with this heading [rad] and curvature [1/m] at stations a
    `step` [m] apart, of at most STEP.
    """
    _check_length(step * (len(heading) - 1))
    station: Array = step * np.arange(float(len(heading)))
    check_bends(station, curvature)
    # Between two stations the heading is taken to be the cubic that path_through makes it.
    rise, slope = np.diff(heading), step * curvature
    t = _AT[:, None]
    between = (
        heading[:-1]
        + t * slope[:-1]
        + t**2 * (3 * rise - 2 * slope[:-1] - slope[1:])
        + t**3 * (slope[:-1] + slope[1:] - 2 * rise)
    )
    x, y = (
        np.concatenate([[0.0], np.cumsum(step * (_WEIGHT @ part))])
        for part in (np.cos(between), np.sin(between))
    )
    return path_through(x, y, heading, curvature, step=step, loop=loop)


def _check_length(length: float) -> None:
    if not LEAST_LENGTH <= length <= _LONGEST:
        raise InputError(
            f"path: {length:.3g} m long: must be at least {LEAST_LENGTH:g} m and at most "
            f"{_LONGEST / 1000:g} km"
        )


def check_bends(station: Array, curvature: Array) -> None:
    """Raises InputError where a bicycle cannot turn so sharply."""
    worst = int(np.argmax(np.abs(curvature)))
    sharpest = abs(float(curvature[worst]))
    if not sharpest <= 1.0001 / LEAST_RADIUS:
        raise InputError(
            f"path: bends with a radius of {1 / sharpest:.2g} m at {station[worst]:.1f} m along "
            f"it: must be at least {LEAST_RADIUS:g} m"
        )
