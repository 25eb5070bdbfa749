"""Arms and legs: two bones from a joint that is given to an end that is given."""

import math

import numpy as np

from bikesim.view.shapes.mesh import Array, aligned, unit

_ALMOST_STRAIGHT = 0.9995


def middle_joint(start: Array, end: Array, upper: float, lower: float, towards: Array) -> Array:
    """The elbow or knee [m] of two bones of given lengths; it bends to the side `towards`.

    Where the end is out of reach the bones lie on the straight line, and stop short of it.
    """
    line = end - start
    reach = float(np.linalg.norm(line))
    along = line / max(reach, 1e-9)
    reach = min(
        max(reach, abs(upper - lower) / _ALMOST_STRAIGHT), _ALMOST_STRAIGHT * (upper + lower)
    )
    before = (upper**2 - lower**2 + reach**2) / (2 * reach)
    out = math.sqrt(max(0.0, upper**2 - before**2))
    side = unit(towards - (towards @ along) * along)
    return start + before * along + out * side


def within_reach(start: Array, end: Array, length: float) -> Array:
    """The start, moved straight towards the end as far as a limb of this length needs [m]."""
    line = end - start
    distance = float(np.linalg.norm(line))
    return start + line * max(0.0, 1 - _ALMOST_STRAIGHT * length / max(distance, 1e-9))


def bone_turn(start: Array, end: Array) -> Array:
    """The rotation matrix of a bone that is drawn along its own z axis."""
    return aligned(end - start)
