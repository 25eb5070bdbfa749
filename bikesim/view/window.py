"""The land about the bicycle, as a window on something that repeats."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

_BEHIND = 70.0  # m behind the bicycle, from where on no view shows what stands there
_ASIDE = 1.8  # m to the side for each metre forward: wider than any view, leaning or not

Array = NDArray[np.float64]


def wrapped(offset: Array, period: float) -> Array:
    """Moved by whole periods to within half of one; rounded, so that equal places look equal."""
    return np.round(offset - period * np.round(offset / period), 7)


def in_sight(offset: Array, heading: float) -> NDArray[np.bool_]:
    """Which places (n, 2), as seen from the bicycle [m], may be in a picture.

    x forward and y to the left along the road; `heading` > 0 is to the right [rad].
    """
    forward = offset @ [math.cos(heading), -math.sin(heading)] + _BEHIND
    aside = offset @ [math.sin(heading), math.cos(heading)]
    return (forward > 0) & (np.abs(aside) < _ASIDE * forward)


def mocap_ids(model: mujoco.MjModel, names: list[str]) -> NDArray[np.int64]:
    """Where the places of bodies that are moved by hand stand in the data."""
    return np.array([model.body_mocapid[model.body(name).id] for name in names])
