"""The rider as meshes: an adult of 1.75 m on the saddle, hands on the grips, feet on the pedals.

Trunk and head are drawn in the rear frame (origin at the rear axle), hands on the bar, feet on the
pedals; each bone of arms and legs along its own z axis from its upper joint.
"""

import math
from typing import NamedTuple

import numpy as np

from bikesim.view.contact import WheelGeometry
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import (
    Array,
    Mesh,
    bent_tube,
    both_sides,
    box,
    ellipsoid,
    joined,
    limb,
    loft,
    vec,
)
from bikesim.view.shapes.places import into_front, places

THIGH, SHANK = 0.435, 0.430  # m
UPPER_ARM, FOREARM = 0.300, 0.265  # m, the forearm to the wrist
ANKLE = (-0.075, 0.0, 0.095)  # m from the middle of the pedal
_TRUNK = 0.475  # m from hip to shoulder
_TRUNK_TILT = math.radians(17)
_GRIP_YAW = math.radians(38)
_HIP_SIDE, _SHOULDER_SIDE = 0.085, 0.185  # m


class Joints(NamedTuple):
    """Left hip and shoulder, and the middle between the eyes, in the rear frame [m]."""

    hip: Array
    shoulder: Array
    eye: Array


def joints(geometry: WheelGeometry) -> Joints:
    """Where the rider on this bicycle has them."""
    saddle = places(geometry).saddle
    hip = saddle + vec(0.015, 0, 0.075)
    up = _up()
    shoulder = hip + _TRUNK * up
    head = _head(shoulder)
    return Joints(
        hip + vec(0, _HIP_SIDE, 0),
        shoulder + vec(0, _SHOULDER_SIDE, 0),
        head + vec(0.095, 0, 0.015),
    )


def _up() -> Array:
    return np.array([math.sin(_TRUNK_TILT), 0, math.cos(_TRUNK_TILT)])


def _head(shoulder: Array) -> Array:
    return shoulder + vec(0.075, 0, 0.225)


def trunk(geometry: WheelGeometry) -> Mesh:
    """From the pelvis to the shoulders, sleeves' roots included."""
    at = joints(geometry)
    hip, shoulder = at.hip * [1, 0, 1], at.shoulder * [1, 0, 1]
    # Along the spine: share of the way from hip to shoulder, forward bend, half depth, half width.
    jersey = [
        (-0.12, 0.000, 0.110, 0.152), (0.0, -0.002, 0.120, 0.163), (0.14, -0.006, 0.116, 0.154),
        (0.32, -0.018, 0.108, 0.147), (0.52, -0.028, 0.110, 0.158), (0.72, -0.026, 0.112, 0.176),
        (0.88, -0.016, 0.102, 0.186), (0.98, -0.006, 0.085, 0.178), (1.06, 0.004, 0.064, 0.120),
        (1.11, 0.012, 0.050, 0.070), (1.12, 0.014, 0.0, 0.0),
    ]  # fmt: skip
    body = loft(
        [(bend, 0, share * _TRUNK, deep, wide) for share, bend, deep, wide in jersey],
        Colour.JERSEY,
        16,
    )
    band = loft(
        [(bend, 0, share * _TRUNK, deep + 0.002, wide + 0.002)
         for share, bend, deep, wide in (
            (0.555, -0.028, 0.1103, 0.1612), (0.64, -0.0275, 0.1113, 0.1690))],
        Colour.JERSEY_LIGHT,
        16,
    )  # fmt: skip
    sleeve = limb(
        shoulder + vec(0.0, 0.09, -0.005), at.shoulder + vec(0, -0.004, 0), 0.070, 0.060,
        Colour.JERSEY, 10, 3,
    )  # fmt: skip
    seat = loft(
        [
            (-0.020, 0, -0.085, 0.0, 0.0), (-0.022, 0, -0.080, 0.070, 0.100),
            (-0.022, 0, -0.050, 0.115, 0.150), (-0.018, 0, -0.005, 0.130, 0.168),
            (-0.006, 0, 0.050, 0.118, 0.158), (0.004, 0, 0.075, 0.10, 0.14),
        ],
        Colour.TROUSERS,
        16,
    )  # fmt: skip
    turn = _leaning()
    return joined(
        [
            body.moved(hip, turn),
            band.moved(hip, turn),
            both_sides(sleeve),
            seat.moved(hip),
        ]
    )


def head(geometry: WheelGeometry) -> Mesh:
    """Neck, head, helmet."""
    shoulder = joints(geometry).shoulder * [1, 0, 1]
    at = _head(shoulder)
    shell = loft(
        [
            (-0.016, 0, 0.005, 0.0, 0.0), (-0.012, 0, 0.012, 0.122, 0.094),
            (-0.008, 0, 0.040, 0.132, 0.101), (-0.010, 0, 0.078, 0.122, 0.093),
            (-0.014, 0, 0.108, 0.093, 0.070), (-0.018, 0, 0.126, 0.050, 0.036),
            (-0.018, 0, 0.131, 0.0, 0.0),
        ],
        Colour.HELMET,
        16,
    )  # fmt: skip
    ribs = [
        ellipsoid([-0.010, y, 0.030], [0.137 - 0.40 * abs(y), 0.0085, 0.106 - 0.40 * abs(y)],
                  Colour.HELMET_STRIPE, 14, 9)
        for y in (-0.045, 0.0, 0.045)
    ]  # fmt: skip
    return joined(
        [
            limb(shoulder + vec(0.012, 0, 0.02), at + vec(-0.012, 0, -0.03), 0.056, 0.052,
                 Colour.SKIN, 10, 0),
            ellipsoid(at + vec(0.008, 0, -0.016), [0.090, 0.075, 0.110], Colour.SKIN, 14, 9),
            ellipsoid(at + vec(-0.020, 0, -0.004), [0.088, 0.080, 0.082], Colour.HAIR, 12, 7),
            ellipsoid(at + vec(0.100, 0, -0.022), [0.016, 0.013, 0.020], Colour.SKIN, 6, 5),
            both_sides(ellipsoid(at + vec(0.0, 0.076, -0.022), [0.020, 0.010, 0.028], Colour.SKIN,
                                 6, 5)),
            joined([shell, *ribs]).moved(at),
        ]
    )  # fmt: skip


def _leaning() -> Array:
    cos, sin = math.cos(_TRUNK_TILT), math.sin(_TRUNK_TILT)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])


def thigh() -> Mesh:
    """From the hip down to the knee."""
    return limb([0, 0, 0], [0, 0, THIGH], 0.086, 0.058, Colour.TROUSERS, 14, 4)


def shank() -> Mesh:
    """Trouser leg, calf, and a piece of skin over the shoe."""
    return joined(
        [
            limb([0, 0, 0], [0, 0, 0.30], 0.058, 0.049, Colour.TROUSERS, 12, 3),
            limb([0, 0, 0.25], [0, 0, SHANK], 0.043, 0.034, Colour.SKIN, 10, 2),
        ]
    )


def shoe() -> Mesh:
    """About the middle of the pedal under its ball."""
    return joined(
        [
            ellipsoid([0.030, 0, 0.040], [0.075, 0.044, 0.030], Colour.SHOE, 12, 7),
            ellipsoid([-0.075, 0, 0.050], [0.060, 0.036, 0.042], Colour.SHOE, 12, 7),
            ellipsoid([-0.030, 0, 0.044], [0.085, 0.040, 0.036], Colour.SHOE, 12, 7),
            box([-0.015, 0, 0.0155], [0.105, 0.036, 0.0065], Colour.SOLE),
            limb([-0.075, 0, 0.06], ANKLE, 0.040, 0.040, Colour.SHOE, 10, 2),
        ]
    )


def upper_arm() -> Mesh:
    """From the shoulder; the sleeve ends over the elbow."""
    return joined(
        [
            limb([0, 0, 0], [0, 0, 0.225], 0.058, 0.050, Colour.JERSEY, 12, 3),
            limb([0, 0, 0.19], [0, 0, UPPER_ARM], 0.043, 0.040, Colour.SKIN, 10, 3),
        ]
    )


def forearm() -> Mesh:
    """From the elbow to the wrist."""
    return limb([0, 0, 0], [0, 0, FOREARM], 0.043, 0.029, Colour.SKIN, 12, 3)


def wrist(geometry: WheelGeometry) -> Array:
    """The left wrist, in the frame of the front assembly [m]."""
    return places(geometry).grip + _level(geometry, [-0.072, 0.020, 0.036])


def hand(geometry: WheelGeometry) -> Mesh:
    """The left hand about the grip, in the frame of the front assembly.

    Drawn about the grip's middle with x across the grip, away from the arm, y along it outwards.
    """
    fingers = []
    for y, reach in ((-0.030, 0.90), (-0.010, 1.0), (0.010, 1.0), (0.029, 0.88)):
        line = [
            [-0.012, y, 0.034], [0.016 * reach, y, 0.031], [0.032 * reach, y, 0.010],
            [0.026 * reach, y, -0.018], [0.006, y, -0.026],
        ]  # fmt: skip
        fingers += [
            bent_tube(line, 0.0105, Colour.SKIN, sides=7),
            limb(line[-2], line[-1], 0.0105, colour=Colour.SKIN, sides=7, rings=2),
        ]
    palm = joined(
        [
            ellipsoid([-0.022, 0.0, 0.026], [0.040, 0.043, 0.017], Colour.SKIN, 12, 7),
            limb([-0.075, 0.006, 0.028], [-0.025, 0.002, 0.028], 0.025, 0.030, Colour.SKIN, 10, 2),
        ]
    )
    thumb = bent_tube(
        [[-0.045, -0.030, 0.018], [-0.018, -0.044, 0.014], [0.010, -0.046, -0.006],
         [0.020, -0.040, -0.020]],
        0.0120,
        Colour.SKIN,
        sides=7,
    )  # fmt: skip
    turn = into_front(geometry.tilt) @ _about_grip()
    return joined([palm, thumb, *fingers]).moved(places(geometry).grip, turn)


def _about_grip() -> Array:
    """The grip runs backwards and outwards: the hand is turned with it, inwards."""
    cos, sin = math.cos(_GRIP_YAW), math.sin(_GRIP_YAW)
    return np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])


def _level(geometry: WheelGeometry, vector: list[float]) -> Array:
    return into_front(geometry.tilt) @ vector
