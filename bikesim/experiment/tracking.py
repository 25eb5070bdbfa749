"""How far from the prescribed path: its deviation at every sample of a run."""

import math

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.history import History
from bikesim.path.path import Path

Reals = NDArray[np.float64]

# Ridden from one sample whose station is sought to the next [m]: less than the path's REACH.
_APART = 1.5


def deviations(history: History, path: Path) -> Reals:
    """Distance (m,) of the rear contact from the path [m], > 0 to the right of it.

    Where a path crosses itself, from the branch that was ridden; NaN where a place is not finite.
    """
    if path.straight:
        return history.y
    if not (np.isfinite(history.x).all() and np.isfinite(history.y).all()):
        return np.full(len(history.time), np.nan)
    return path.place(history.x, history.y, _stations(history, path)).deviation


def _stations(history: History, path: Path) -> Reals:
    """About where along the path each sample is [m], (m,)."""
    samples = np.arange(len(history.time))
    some = np.unique(np.append(samples[:: _stride(history)], samples[-1:]))
    x, y = history.x[some], history.y[some]
    found, station, heading = [], 0.0, path.heading(0.0)
    for at_x, at_y, dx, dy in zip(
        *(values.tolist() for values in (x, y, np.diff(x, prepend=0.0), np.diff(y, prepend=0.0))),
        strict=True,
    ):
        # Each from where the last one was, so it is the branch that was ridden.
        ahead = dx * math.cos(heading) + dy * math.sin(heading)
        station, _, heading = path.place(at_x, at_y, station + ahead)
        found.append(station)
    return np.interp(samples, some, found)


def _stride(history: History) -> int:
    """Samples from one whose station is sought to the next."""
    moved = float(np.abs(history.speed).max()) * history.period
    return max(1, int(_APART / moved)) if moved > 0 else len(history.time)
