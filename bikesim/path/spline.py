"""The smooth path through given points."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bikesim.path.csv_file import Point, check_points
from bikesim.path.path import Array, Path
from bikesim.path.tracing import Curve, Trace, traced

_SAME = 1e-6  # m


def path_along(points: Sequence[Point]) -> Path:
    """The cubic spline through the points (x, y) [m], by the distance between them.

    Moved and turned to set out from the origin along +x, an open one towards its second point.
    Where the last point is the first, the path is closed. Raises InputError.
    """
    from scipy.interpolate import CubicSpline

    different = [points[i] for i in range(len(points)) if not i or points[i] != points[i - 1]]
    check_points(different)
    xy = np.array(different)
    closed = bool(np.hypot(*(xy[-1] - xy[0])) < _SAME)
    if closed:
        xy[-1] = xy[0]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    z = xy @ [1, 1j]
    # An open one sets out towards its second point, so that one laid out along +x is not turned.
    towards = (z[1] - z[0]) / along[1]
    ends: Any = "periodic" if closed else ((1, towards), (2, 0.0))
    spline = CubicSpline(along, z, bc_type=ends)
    first, direction = z[0], spline(0.0, 1) if closed else towards
    turned = np.conj(direction) / abs(direction)

    def at(u: Array) -> Trace:
        z, dz, ddz = (turned * (spline(u, k) - (0 if k else first)) for k in range(3))
        return Trace(z.real, z.imag, dz.real, dz.imag, ddz.real, ddz.imag)

    return traced(Curve(at, float(along[-1]), loop=0.0 if closed else None))
