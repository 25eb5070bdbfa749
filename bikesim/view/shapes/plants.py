"""Trees and bushes. What is drawn far away is drawn with fewer sides."""

import math
from typing import NamedTuple

import numpy as np

from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import Mesh, ellipsoid, joined, limb, turned_profile


class Detail(NamedTuple):
    """How finely something is drawn."""

    sides: int
    rings: int
    near: bool


NEAR, FAR = Detail(8, 6, True), Detail(6, 4, False)
_LEAVES = (
    (Colour.LEAF, Colour.LEAF_LIGHT),
    (Colour.LEAF_DARK, Colour.LEAF),
    (Colour.LEAF_DARK, Colour.LEAF_LIGHT),
)


def tree(chance: np.random.Generator, detail: Detail) -> Mesh:
    """One of three kinds, about 5 to 9 m high."""
    chance = own(chance)
    kind = chance.choice(3, p=[0.55, 0.25, 0.20])
    return (_broadleaf, _birch, _fir)[kind](chance, detail)


def bush(chance: np.random.Generator, detail: Detail) -> Mesh:
    """Two or three round bushes in a heap."""
    chance = own(chance)
    leaf = (Colour.LEAF, Colour.LEAF_DARK, Colour.LEAF_LIGHT)[chance.integers(3)]
    parts = []
    for k in range(3 if detail.near else 1):
        size = chance.uniform(0.7, 1.3)
        at = [1.1 * k + chance.uniform(-0.3, 0.3), chance.uniform(-0.6, 0.6), 0.55 * size]
        parts.append(crown(at, [size, size, 0.85 * size], leaf, detail, chance))
    return joined(parts)


def _broadleaf(chance: np.random.Generator, detail: Detail) -> Mesh:
    """A round crown; near by, of several balls, the upper ones lighter."""
    height, width = chance.uniform(5.0, 7.5), chance.uniform(1.9, 2.6)
    dark, light = _LEAVES[chance.integers(len(_LEAVES))]
    parts = [trunk(height * 0.55, 0.17, Colour.BARK)]
    if not detail.near:
        radii = [1.05 * width, 1.05 * width, height * 0.33]
        return joined([*parts, crown([0, 0, height * 0.66], radii, dark, detail, chance)])
    start = chance.uniform(0, 2 * math.pi)
    for k in range(4):
        angle, size = start + 1.57 * k, width * chance.uniform(0.58, 0.72)
        at = [0.50 * width * math.cos(angle), 0.50 * width * math.sin(angle),
              height * (0.56 + 0.05 * (k % 2))]  # fmt: skip
        parts.append(crown(at, [size, size, 0.92 * size], dark, detail, chance))
    for k in range(2):
        at = [(0.5 - k) * 0.5 * width, 0.1 * width, height * (0.74 + 0.06 * k)]
        size = width * (0.66 - 0.08 * k)
        parts.append(crown(at, [size, size, 0.9 * size], light, detail, chance))
    return joined(parts)


def _birch(chance: np.random.Generator, detail: Detail) -> Mesh:
    height = chance.uniform(6.5, 9.0)
    width = 0.19 * height
    leaf = Colour.LEAF_LIGHT
    low = crown([0, 0, height * 0.52], [width, width, height * 0.27], leaf, detail, chance)
    high = crown(
        [0.1, 0, height * 0.76], [0.7 * width, 0.7 * width, height * 0.23], leaf, detail, chance
    )
    return joined([trunk(height * 0.6, 0.11, Colour.BIRCH), low, high])


def _fir(chance: np.random.Generator, detail: Detail) -> Mesh:
    height = chance.uniform(6.0, 9.0)
    parts = [trunk(height * 0.3, 0.16, Colour.BARK)]
    tiers = 3 if detail.near else 2
    for k in range(tiers):
        low = height * (0.14 + 0.75 * k / tiers)
        top = low + height * 0.86 / tiers * 1.25
        radius = 0.23 * height * (1 - 0.75 * k / tiers)
        parts.append(
            turned_profile(
                [(0.01, low + 0.1), (radius, low), (0.01, min(top, height))],
                Colour.FIR,
                detail.sides,
            )
        )
    return joined(parts)


def trunk(height: float, radius: float, colour: Colour) -> Mesh:
    """From a little under the ground."""
    return limb([0, 0, -0.1], [0, 0, height], radius, 0.7 * radius, colour, 6, 0)


def crown(
    at: list[float], radii: list[float], leaf: Colour, detail: Detail, chance: np.random.Generator
) -> Mesh:
    """A ball of leaves, a little uneven."""
    ball = ellipsoid(at, radii, leaf, detail.sides, detail.rings)
    spin = chance.uniform(0, 2 * math.pi)
    local = (ball.corners - at) / radii
    bumps = 1 + 0.10 * np.sin(4 * np.arctan2(local[:, 1], local[:, 0]) + spin) * np.sqrt(
        np.clip(1 - local[:, 2] ** 2, 0, 1)
    ) * np.cos(3 * local[:, 2] + spin)
    return ball._replace(corners=np.asarray(at) + local * bumps[:, None] * radii)


def own(chance: np.random.Generator) -> np.random.Generator:
    """A chance for one thing, so that how finely it is drawn does not move what comes after."""
    return np.random.default_rng(chance.integers(2**32))


def tuft(chance: np.random.Generator, colour: Colour) -> Mesh:
    """A small clump of grass or flowers."""
    height, width = chance.uniform(0.18, 0.38), chance.uniform(0.14, 0.25)
    profile = [(width, 0.0), (0.7 * width, 0.6 * height), (0.01, height)]
    return turned_profile(profile, colour, 5)
