"""How far from the prescribed path: its deviation at every sample of a run."""

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.history import History
from bikesim.path.path import Path

Reals = NDArray[np.float64]

# Samples from one whose station is sought to the next: at 100 Hz 0.1 s.
_STRIDE = 10


def deviations(history: History, path: Path) -> Reals:
    """Distance (m,) of the rear contact from the path [m], > 0 to the right of it.

    Where a path crosses itself, from the branch that was ridden.
    """
    if path.straight:
        return history.y
    return path.place(history.x, history.y, _stations(history, path)).deviation


def _stations(history: History, path: Path) -> Reals:
    """About where along the path each sample is [m], (m,)."""
    samples = np.arange(len(history.time))
    some = samples[::_STRIDE]
    moved = np.diff(np.cumsum(history.speed)[some] * history.period, prepend=0.0)
    found, station = [], 0.0
    for x, y, way in zip(history.x[some].tolist(), history.y[some].tolist(), moved.tolist(),
                         strict=True):  # fmt: skip
        station = path.place(x, y, station + way).station
        found.append(station)
    return np.interp(samples, some, found)
