"""The paths that have a formula: lane changes, slalom, circle, figure of eight."""

from collections.abc import Callable, Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from bikesim.path.path import Array, Path
from bikesim.path.tracing import STEP, Curve, Trace, by_curvature, traced

# Length of Bernoulli's lemniscate of half-width 1: Γ(1/4)² / √(2 π).
LEMNISCATE = 5.2441151085842396
_RUN_OUT = 10.0  # m, straight on after the last change


class _Piece(NamedTuple):
    """A part of a course y(x): its length in x [m]; y, y', y'' by the x from its begin [m]."""

    length: float
    at: Callable[[Array], tuple[Array, Array, Array]]


def lane_change(start: float, offset: float, length: float, back: bool, hold: float) -> Path:
    """To another lane, and back again if so asked."""
    if back:
        return double_lane_change(start, offset, length, hold, length)
    return _course([_straight(start, 0.0), _change(0.0, offset, length), _straight(10.0, offset)])


def double_lane_change(
    start: float, offset: float, length: float, hold: float, return_length: float
) -> Path:
    """To another lane and back, in the manner of ISO 3888-2."""
    return _course(
        [
            _straight(start, 0.0),
            _change(0.0, offset, length),
            _straight(hold, offset),
            _change(offset, 0.0, return_length),
            _straight(_RUN_OUT, 0.0),
        ]
    )


def slalom(start: float, amplitude: float, wavelength: float, count: int) -> Path:
    """`count` bends, right and left in turn: ± amplitude cos(2π x / wavelength) between the first
    peak and the last; in and out over half a wavelength, with continuous curvature.
    """
    half, wave = 0.5 * wavelength, 2 * pi / wavelength

    def swing(x: Array) -> tuple[Array, Array, Array]:
        cos, sin = amplitude * np.cos(wave * x), amplitude * np.sin(wave * x)
        return cos, -wave * sin, -(wave**2) * cos

    last = amplitude * (-1) ** (count - 1)
    peak = pi**2  # -y'' of a peak of 1, with half a wavelength as unit
    rise = (0.0, 0.0, 0.0, 10 - 0.5 * peak, peak - 15, 6 - 0.5 * peak)
    fall = (1.0, 0.0, -0.5 * peak, 1.5 * peak - 10, 15 - 1.5 * peak, 0.5 * peak - 6)
    return _course(
        [
            _straight(start, 0.0),
            _polynomial(half, [amplitude * c for c in rise]),
            _Piece(half * (count - 1), swing),
            _polynomial(half, [last * c for c in fall]),
            _straight(_RUN_OUT, 0.0),
        ]
    )


def _straight(length: float, lane: float) -> _Piece:
    return _polynomial(length, [lane])


def _change(lane: float, to: float, length: float) -> _Piece:
    """y = rise (10 u³ - 15 u⁴ + 6 u⁵), u = x / length: the least jerk (Flash & Hogan 1985), and
    neither slope nor curvature at both ends.
    """
    rise = to - lane
    return _polynomial(length, [lane, 0.0, 0.0, 10 * rise, -15 * rise, 6 * rise])


def _polynomial(length: float, powers: Sequence[float]) -> _Piece:
    """y by powers of x / length."""
    value = np.polynomial.Polynomial(powers)
    first, second = value.deriv(), value.deriv(2)

    def at(x: Array) -> tuple[Array, Array, Array]:
        u = x / length
        return value(u), first(u) / length, second(u) / length**2

    return _Piece(length, at)


def _course(pieces: Sequence[_Piece]) -> Path:
    """The path along pieces of y(x), one behind the other."""
    ends = np.cumsum([piece.length for piece in pieces])

    def at(x: Array) -> Trace:
        y, dy, ddy = np.zeros((3, len(x)))
        which = np.minimum(np.searchsorted(ends, x, side="right"), len(pieces) - 1)
        for k, piece in enumerate(pieces):
            if (here := which == k).any():
                y[here], dy[here], ddy[here] = piece.at(x[here] - (ends[k] - piece.length))
        return Trace(x, y, np.ones_like(x), dy, np.zeros_like(x), ddy)

    return traced(Curve(at, float(ends[-1])))


def circle(start: float, radius: float, side: str, entry: float) -> Path:
    """A circle ridden round and round; its curvature sets in over `entry` [m] as
    (10 u³ - 15 u⁴ + 6 u⁵) / radius.
    """
    before, turn = start + entry, _turn(side) / radius
    end = before + 2 * pi * radius
    count = int(np.ceil(end / STEP))
    station = np.linspace(0.0, end, count + 1)
    u = np.clip((station - start) / entry, 0.0, 1.0)
    curvature = turn * (10 * u**3 - 15 * u**4 + 6 * u**5)
    heading = turn * (entry * (2.5 * u**4 - 3 * u**5 + u**6) + np.maximum(station - before, 0.0))
    return by_curvature(curvature, heading, end / count, loop=before)


def figure_eight(start: float, radius: float, side: str) -> Path:
    """Bernoulli's lemniscate, ridden again and again from its crossing, where it is straight.

    Its curvature grows with the distance from the crossing, to 1 / radius at both ends; its
    half-width is 3 radius, a lap 15.7 radius.
    """
    half_width, turn = 3 * radius, _turn(side)
    # The parameter of z = cos t / (1 - i sin t) by metre; the crossing is at t = -π/2.
    rate = 2 * pi / (LEMNISCATE * half_width)
    pace = half_width * rate / np.sqrt(2)  # of the curve at the crossing; the way there keeps it
    before = start / pace

    def at(u: Array) -> Trace:
        on = u < before
        t = rate * np.maximum(u - before, 0.0) - 0.5 * pi
        z, dz, ddz = half_width * _lemniscate(t) * np.array([[1], [rate], [rate**2]])
        return Trace(
            np.where(on, pace * u, start + z.real),
            np.where(on, 0.0, turn * z.imag),
            np.where(on, pace, dz.real),
            np.where(on, 0.0, turn * dz.imag),
            np.where(on, 0.0, ddz.real),
            np.where(on, 0.0, turn * ddz.imag),
        )

    return traced(Curve(at, before + LEMNISCATE * half_width, loop=before))


def _lemniscate(t: Array) -> np.ndarray:
    """Of half-width 1, turned by 45 degrees: x + i y, and its first and second derivatives."""
    sin, cos = np.sin(t), np.cos(t)
    below = 1 - 1j * sin
    curve = np.stack([cos / below, (1j - sin) / below**2, -cos * (3 + 1j * sin) / below**3])
    return np.exp(0.25j * pi) * curve


def _turn(side: str) -> float:
    return 1.0 if side == "right" else -1.0
