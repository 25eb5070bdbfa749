"""Where the parts of a bicycle meet, from its own geometry.

The rear frame is drawn about the rear axle; the front assembly about the point of the steer axis
nearest to the front axle, its z along the axis; x forward, y left, z up. Everything that the
parameters leave open has the proportions of a city bicycle with a fairly level bar.
"""

import math
from typing import NamedTuple

import numpy as np

from bikesim.view.contact import WheelGeometry
from bikesim.view.shapes.mesh import Array, vec

CRANK_LENGTH = 0.170  # m
PEDAL_SIDE = 0.125  # m from the middle plane to the middle of a pedal
GRIP_SIDE = 0.285  # m from the middle plane to the middle of a grip
GRIP_BACK = 0.115  # m, grips behind the steer axis: a swept bar
_BOTTOM_BRACKET_HEIGHT = 0.285  # m
_CHAIN_STAY = 0.44  # m
_SADDLE_HEIGHT = 0.97  # m
_BAR_HEIGHT = 1.03  # m
_SEAT_ANGLE = math.radians(72.5)


class Places(NamedTuple):
    """Points that other parts are joined to [m]: of the rear frame, but the grips of the front."""

    bottom_bracket: Array
    saddle: Array
    fork: Array
    grip: Array  # left one, in the frame of the front assembly
    front_axle: Array  # the same


def places(geometry: WheelGeometry) -> Places:
    """Where the parts of a bicycle of this geometry meet."""
    rear = geometry.rear_radius
    drop = _BOTTOM_BRACKET_HEIGHT - rear
    bracket = np.array([math.sqrt(max(0.3**2, _CHAIN_STAY**2 - drop**2)), 0, drop])
    rise = _SADDLE_HEIGHT - _BOTTOM_BRACKET_HEIGHT
    saddle = bracket + vec(-rise / math.tan(_SEAT_ANGLE), 0, rise)
    foot_x, foot_z = geometry.axis_foot
    up = (_BAR_HEIGHT - rear - foot_z) / math.cos(geometry.tilt)
    # Level ground coordinates of the bar, told in the tilted frame of the front assembly.
    sin, cos = math.sin(geometry.tilt), math.cos(geometry.tilt)
    grip = np.array([-GRIP_BACK * cos, GRIP_SIDE, up + GRIP_BACK * sin])
    return Places(
        bracket,
        saddle,
        np.array([foot_x, 0, foot_z]),
        grip,
        np.array([geometry.fork_offset, 0, 0]),
    )


def head_tube(geometry: WheelGeometry) -> tuple[Array, Array]:
    """Its lower and upper end, in the rear frame [m]."""
    fork = places(geometry).fork
    axis = np.array([-math.sin(geometry.tilt), 0, math.cos(geometry.tilt)])
    low = max(geometry.front_radius + 0.075, 0.40)
    high = max(0.79 - geometry.rear_radius - fork[2], low + 0.10)
    return fork + low * axis, fork + high * axis


def into_front(tilt: float) -> Array:
    """The matrix that takes directions of the rear frame into the tilted front assembly's."""
    cos, sin = math.cos(tilt), math.sin(tilt)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
