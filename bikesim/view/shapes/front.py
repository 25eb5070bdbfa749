"""The front assembly: fork, stem, bar, lamp."""

import math

import numpy as np

from bikesim.view.contact import WheelGeometry
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import (
    Array,
    Mesh,
    bent_tube,
    both_sides,
    ellipsoid,
    joined,
    limb,
    turned_profile,
    vec,
)
from bikesim.view.shapes.places import GRIP_BACK, into_front, places
from bikesim.view.shapes.wheels import mudguard


def front_assembly(geometry: WheelGeometry) -> tuple[Mesh, Mesh]:
    """Painted fork; bare stem, bar, grips, lamp."""
    at = places(geometry)
    axle = at.front_axle
    crown = max(geometry.front_radius + 0.050, 0.38)
    legs = bent_tube(
        [
            [0, 0.040, crown],
            [0.10 * axle[0], 0.044, 0.62 * crown],
            [0.35 * axle[0], 0.048, 0.30 * crown],
            [axle[0], 0.052, 0],
        ],
        0.0115,
        Colour.FRAME,
    )
    painted = [
        both_sides(legs),
        both_sides(limb([0, 0, crown + 0.006], [0, 0.040, crown], 0.016, 0.0125,
                        colour=Colour.FRAME)),
        limb([0, 0, crown], [0, 0, crown + 0.03], 0.021, colour=Colour.FRAME, rings=0),
    ]  # fmt: skip
    bare = [
        _bar(at.grip, geometry.tilt),
        both_sides(limb(axle + vec(0, 0.040, 0), axle + vec(0, 0.066, 0), 0.009, sides=8)),
        mudguard(geometry.front_radius, math.radians(50), math.radians(185)).moved(
            axle, into_front(geometry.tilt)),
        _front_lamp(at.grip),
    ]  # fmt: skip
    return joined(painted), joined(bare)


def _bar(grip: Array, tilt: float) -> Mesh:
    """Stem and bar: rises, reaches sideways, sweeps back to the grips."""
    level = into_front(tilt)
    middle = grip * [1, 0, 1] + level @ [GRIP_BACK + 0.045, 0, -0.012]
    top = middle[2] - 0.035
    stem = [
        limb([0, 0, 0.30], [0, 0, top], 0.0145, colour=Colour.STEEL),
        limb([0, 0, top], middle, 0.0150, 0.0165, colour=Colour.STEEL),
        limb([0, 0, 0.445], [0, 0, 0.46], 0.021, colour=Colour.STEEL, rings=0),
    ]
    back = level @ np.array([1.0, 0, 0])
    end = grip + level @ [-0.055, 0.032, 0]
    line = np.array(
        [
            middle,
            middle + vec(0, 0.080, 0),
            middle + vec(0, 0.145, 0.006) - 0.012 * back,
            middle + vec(0, 0.195, 0.012) - 0.050 * back,
            grip + level @ [0.075, -0.036, 0.002],
            grip,
            end,
        ]
    )
    tube = bent_tube(line, 0.0112, Colour.ALUMINIUM)
    rubber = limb(grip + level @ [0.045, -0.022, 0], end, 0.0165, colour=Colour.LEATHER)
    lever = bent_tube(
        [
            grip + level @ [0.085, -0.050, -0.012],
            grip + level @ [0.080, -0.005, -0.028],
            grip + level @ [0.045, 0.040, -0.034],
        ],
        0.0050,
        Colour.STEEL,
        sides=5,
    )
    bell = turned_profile(
        [(0.024, 0.0), (0.024, 0.006), (0.017, 0.016), (1e-4, 0.020)], Colour.STEEL, 12
    ).moved(middle + vec(0, 0.085, 0.010))
    return joined([*stem, both_sides(joined([tube, rubber, lever])), bell])


def _front_lamp(grip: Array) -> Mesh:
    at = np.array([0.055, 0, grip[2] - 0.17])
    return joined(
        [
            ellipsoid(at, [0.034, 0.030, 0.030], Colour.SOLE, 10, 7),
            ellipsoid(at + vec(0.014, 0, 0), [0.024, 0.026, 0.026], Colour.JERSEY_LIGHT, 10, 7),
            limb([0, 0, at[2] - 0.01], at, 0.006, colour=Colour.STEEL, sides=5),
        ]
    )
