"""Both wheels on the ground: the pitch of a bicycle that leans and steers.

Frame of the drawing: x forward, y left, z up, origin at the rear axle, turned with the rear frame.
Wheels are thin discs. The rear one touches at its own lowest point whatever the pitch, for it turns
about its own axle; the pitch is what brings the lowest point of the front one to the ground.
"""

import math
from typing import NamedTuple

from bikesim.model.bicycle import Bicycle

USUAL_WHEEL_RADIUS = 0.335  # m, of a bicycle known by its matrices only: 700C with a 32 mm tyre
_MAX_STEP = 0.3  # rad
_STEEPEST = 1.0  # rad; only a bicycle that lies on the ground would go beyond
_STEPS = 60


class WheelGeometry(NamedTuple):
    """What holds the wheels [m, m, rad, m, m]; trail and tilt as in [M07]."""

    wheelbase: float
    trail: float
    tilt: float
    rear_radius: float
    front_radius: float

    @property
    def fork_offset(self) -> float:
        """Distance of the front axle before the steer axis, square to it [m]."""
        return self.front_radius * math.sin(self.tilt) - self.trail * math.cos(self.tilt)

    @property
    def axis_foot(self) -> tuple[float, float]:
        """x and z of the point of the steer axis that is nearest to the front axle [m]."""
        offset, height = self.fork_offset, self.front_radius - self.rear_radius
        return (
            self.wheelbase - offset * math.cos(self.tilt),
            height - offset * math.sin(self.tilt),
        )


def wheel_geometry(bicycle: Bicycle) -> WheelGeometry:
    """The geometry of a bicycle; usual wheels where its matrices alone are known."""
    known = bicycle.parameters
    rear, front = (known.rR, known.rF) if known else (USUAL_WHEEL_RADIUS, USUAL_WHEEL_RADIUS)
    return WheelGeometry(bicycle.wheelbase, bicycle.trail, bicycle.steer_axis_tilt, rear, front)


def contact_pitch(geometry: WheelGeometry, roll: float, steer: float) -> float:
    """The pitch [rad], nose down positive, at which both wheels touch the ground.

    `roll` > 0 leans and `steer` > 0 turns to the right [rad]. Newton's method on the height of the
    front wheel's lowest point; the result is exact to rounding.
    """
    pitch = 0.0
    for _ in range(_STEPS):
        height, slope = _clearance(geometry, roll, steer, pitch)
        if abs(height) < 1e-13 or slope == 0:
            break
        step = height / slope
        pitch -= max(-_MAX_STEP, min(_MAX_STEP, step))
    return max(-_STEEPEST, min(_STEEPEST, pitch))


def _clearance(
    geometry: WheelGeometry, roll: float, steer: float, pitch: float
) -> tuple[float, float]:
    """Height of the front wheel's lowest point over the ground [m], and its derivative [m/rad]."""
    offset, (foot_x, foot_z) = geometry.fork_offset, geometry.axis_foot
    cos_tilt, sin_tilt = math.cos(geometry.tilt), math.sin(geometry.tilt)
    cos_steer, sin_steer = math.cos(steer), math.sin(steer)
    axle = (
        foot_x + offset * cos_steer * cos_tilt,
        -offset * sin_steer,
        foot_z + offset * cos_steer * sin_tilt,
    )
    normal = (sin_steer * cos_tilt, cos_steer, sin_steer * sin_tilt)
    height, height_slope = _raised(axle, roll, pitch)
    lean, lean_slope = _raised(normal, roll, pitch)
    upright = math.sqrt(max(1e-12, 1 - lean * lean))
    radius = geometry.front_radius
    return (
        geometry.rear_radius * math.cos(roll) + height - radius * upright,
        height_slope + radius * lean * lean_slope / upright,
    )


def _raised(vector: tuple[float, float, float], roll: float, pitch: float) -> tuple[float, float]:
    """The vertical part of a vector of the rear frame, and its derivative by pitch."""
    x, y, z = vector
    cos, sin = math.cos(pitch), math.sin(pitch)
    upwards = math.cos(roll)
    return y * math.sin(roll) + upwards * (z * cos - x * sin), upwards * (-z * sin - x * cos)
