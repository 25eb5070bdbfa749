"""The rear frame and what is on it: saddle, cranks, chain."""

import math

import numpy as np

from bikesim.view.contact import WheelGeometry
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import (
    Mesh,
    bent_tube,
    both_sides,
    box,
    ellipsoid,
    joined,
    limb,
    ring,
    vec,
)
from bikesim.view.shapes.places import CRANK_LENGTH, head_tube, places
from bikesim.view.shapes.wheels import guard_stay, mudguard


def rear_frame(geometry: WheelGeometry) -> tuple[Mesh, Mesh]:
    """Painted tubes, and what is bare on them: saddle, post, guard, lamp, stays' ends."""
    at = places(geometry)
    bracket, saddle = at.bottom_bracket, at.saddle
    seat_lug = bracket + 0.80 * (saddle - bracket)
    head_low, head_high = head_tube(geometry)
    painted = [
        limb(bracket, seat_lug, 0.0165, colour=Colour.FRAME),
        limb(bracket, head_low, 0.0205, colour=Colour.FRAME),
        limb(seat_lug, head_high, 0.0165, colour=Colour.FRAME),
        limb(head_low, head_high, 0.0235, colour=Colour.FRAME, rings=0),
        limb(bracket + vec(0, -0.036, 0), bracket + vec(0, 0.036, 0), 0.023, colour=Colour.FRAME,
             rings=0),
        both_sides(limb([0, 0.060, 0], bracket + vec(-0.02, 0.028, 0), 0.0085, 0.011,
                        colour=Colour.FRAME)),
        both_sides(limb([0, 0.060, 0], seat_lug + vec(0, 0.020, 0), 0.0075, colour=Colour.FRAME)),
    ]  # fmt: skip
    post_top = saddle - vec(0, 0, 0.045)
    bare = [
        limb(seat_lug, post_top, 0.0135, colour=Colour.STEEL),
        both_sides(limb([0, 0.050, 0], [0, 0.072, 0], 0.010, colour=Colour.STEEL, sides=8)),
        _saddle().moved(saddle),
        mudguard(geometry.rear_radius, math.radians(25), math.radians(190)),
        _rear_lamp(geometry),
        both_sides(guard_stay(geometry.rear_radius, math.radians(150))),
    ]
    return joined(painted), joined(bare)


def _rear_lamp(geometry: WheelGeometry) -> Mesh:
    reach, angle = geometry.rear_radius + 0.028, math.radians(150)
    at = np.array([reach * math.cos(angle), 0, reach * math.sin(angle)])
    return ellipsoid(at + vec(-0.008, 0, 0), [0.016, 0.034, 0.022], Colour.LAMP, 10, 7)


def _saddle() -> Mesh:
    """About its top's middle; the nose points forward."""
    shell = joined(
        [
            ellipsoid([-0.065, 0, -0.018], [0.085, 0.082, 0.028], Colour.LEATHER),
            ellipsoid([0.045, 0, -0.020], [0.125, 0.030, 0.022], Colour.LEATHER),
        ]
    )
    rails = both_sides(
        bent_tube(
            [
                [-0.10, 0.03, -0.035],
                [-0.03, 0.022, -0.05],
                [0.05, 0.02, -0.05],
                [0.11, 0.008, -0.03],
            ],
            0.0045,
            Colour.STEEL,
            sides=5,
        )
    )
    return joined([shell, rails])


def crank_set() -> Mesh:
    """Chain wheel and cranks about the bottom bracket, the right crank forward."""
    wheel_side = -0.045
    chain_ring = ring(
        [(0.088, -0.0015), (0.088, 0.0015), (0.066, 0.0015), (0.066, -0.0015)], Colour.STEEL, 28
    ).moved([0, wheel_side, 0])
    arms = [
        limb([0, wheel_side, 0], [0.075 * math.cos(t), wheel_side, 0.075 * math.sin(t)], 0.006,
             colour=Colour.STEEL, sides=6)
        for t in np.arange(5) * 2 * math.pi / 5
    ]  # fmt: skip
    axle = limb([0, -0.062, 0], [0, 0.062, 0], 0.010, colour=Colour.STEEL, sides=8, rings=0)
    cranks = [
        limb([0, side * 0.064, 0], [-side * CRANK_LENGTH, side * 0.072, 0], 0.0125, 0.010,
             colour=Colour.ALUMINIUM, sides=8)
        for side in (-1, 1)
    ]  # fmt: skip
    return joined([chain_ring, axle, *arms, *cranks])


def chain(geometry: WheelGeometry) -> Mesh:
    """Its two straight runs, on the right."""
    bracket = places(geometry).bottom_bracket + vec(0, -0.045, 0)
    sprocket = np.array([0, -0.045, 0])
    runs = [
        bent_tube([sprocket + vec(0, 0, s * 0.036), bracket + vec(0, 0, s * 0.087)], 0.0042,
                  Colour.SOLE, sides=5)
        for s in (1, -1)
    ]  # fmt: skip
    cog = limb([0, -0.047, 0], [0, -0.043, 0], 0.036, colour=Colour.STEEL, sides=16, rings=0)
    return joined([*runs, cog])


def pedal() -> Mesh:
    """About its middle."""
    return joined(
        [
            box([0, 0, 0], [0.045, 0.042, 0.009], Colour.SOLE),
            limb([0, -0.055, 0], [0, 0.055, 0], 0.006, colour=Colour.STEEL, sides=6, rings=0),
        ]
    )
