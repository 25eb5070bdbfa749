"""Wheels, their mudguards, and the soft shadow under them."""

import math

import numpy as np

from bikesim.view.contact import WheelGeometry
from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import (
    Mesh,
    bent_tube,
    both_sides,
    joined,
    limb,
    polygon,
    ring,
    surface,
    vec,
)

_TYRE_HALF = 0.0155  # m


def wheel(radius: float, *, rear: bool) -> tuple[Mesh, Mesh]:
    """Tyre and bright parts of a wheel about its axle (y); its crown is the thin disc of `radius`.

    The crown is a blunt edge, so that it is what touches the ground up to a lean of 40 degrees.
    """
    half = _TYRE_HALF
    inner = radius - 2.1 * half
    tyre = ring(
        [
            (radius, 0.0),
            (radius - 0.55 * half, 0.62 * half),
            (radius - 1.1 * half, half),
            (inner, 0.55 * half),
            (inner, -0.55 * half),
            (radius - 1.1 * half, -half),
            (radius - 0.55 * half, -0.62 * half),
        ],
        Colour.RUBBER,
        64,
    )
    rim = ring(
        [
            (inner + 0.003, 0.010),
            (inner - 0.016, 0.007),
            (inner - 0.016, -0.007),
            (inner + 0.003, -0.010),
        ],
        Colour.ALUMINIUM,
        36,
    )
    width = 0.055 if rear else 0.045
    hub = limb([0, -width, 0], [0, width, 0], 0.016, colour=Colour.ALUMINIUM, sides=8, rings=0)
    flanges = both_sides(
        limb([0, 0.026, 0], [0, 0.030, 0], 0.030, colour=Colour.STEEL, sides=10, rings=0)
    )
    valve = limb([inner - 0.055, 0, 0], [inner, 0, 0], 0.004, colour=Colour.RUBBER, sides=4)
    bright = joined([rim, hub, flanges, valve, _spokes(inner - 0.014)])
    return tyre, bright


def _spokes(radius: float, count: int = 28) -> Mesh:
    """Crossed in the usual way, each a thin three-sided rod."""
    rods = []
    for k in range(count):
        at = 2 * math.pi * k / count
        side = 0.028 if k % 2 else -0.028
        lead = 0.75 if (k // 2) % 2 else -0.75
        hub = 0.028 * np.array([math.cos(at + lead), 0, math.sin(at + lead)])
        end = [radius * math.cos(at), 0, radius * math.sin(at)]
        rods.append(bent_tube([hub + vec(0, side, 0), end], 0.0014, Colour.STEEL, sides=3))
    return joined(rods)


def mudguard(radius: float, start: float, end: float) -> Mesh:
    """A strip over the wheel from angle to angle [rad], counted from forward over the top."""
    angles = np.linspace(start, end, 18)
    across = np.linspace(-1, 1, 5)
    reach = radius + 0.016
    profile = [(reach - 0.010 * y * y, 0.026 * y) for y in across]
    grid = np.array([[[r * math.cos(t), y, r * math.sin(t)] for t in angles] for r, y in profile])
    normals = np.array([[[math.cos(t), 0.5 * y, math.sin(t)] for t in angles] for y in across])
    outside = surface(grid, normals, Colour.FRAME_DARK, closed=False)
    inside = outside._replace(
        triangles=outside.triangles[:, ::-1],
        normals=-outside.normals,
        corners=outside.corners - 0.003 * outside.normals,
    )
    a, b, c = outside.corners[outside.triangles[0]]
    if np.cross(b - a, c - a) @ outside.normals[outside.triangles[0, 0]] < 0:
        outside = outside._replace(triangles=outside.triangles[:, ::-1])
        inside = inside._replace(triangles=inside.triangles[:, ::-1])
    return joined([outside, inside])


def guard_stay(radius: float, angle: float) -> Mesh:
    """On the left, from the axle to the guard at an angle [rad]."""
    reach = radius + 0.012
    end = [reach * math.cos(angle), 0.024, reach * math.sin(angle)]
    return bent_tube([[0, 0.062, 0], end], 0.0025, Colour.STEEL, sides=4)


def shade(geometry: WheelGeometry) -> Mesh:
    """Sheets one over the other on the ground: dark under the bicycle, softer outwards."""
    angles = np.linspace(0, 2 * math.pi, 25)[:-1]
    sheets = []
    for k, size in enumerate((1.0, 0.82, 0.66, 0.50, 0.34)):
        long, wide = size * (0.5 * geometry.wheelbase + 0.26), 0.20 * size
        ring_ = [
            [0.5 * geometry.wheelbase + long * math.cos(t), wide * math.sin(t), 0.0012 + 2e-4 * k]
            for t in angles
        ]
        sheets.append(polygon(ring_, Colour.RUBBER))
    return joined(sheets)
