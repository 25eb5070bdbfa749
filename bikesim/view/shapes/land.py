"""The land in squares: copses, hedges, farms, crops, and the road's own furniture.

Everything lies on the plane z = 0 about the middle of its square; x along the road. Fixed seeds:
the land is the same in every picture.
"""

import math

import numpy as np

from bikesim.view.shapes.colour import Colour
from bikesim.view.shapes.mesh import Array, Mesh, box, joined, polygon
from bikesim.view.shapes.plants import FAR, Detail, bush, crown, tree, trunk, tuft

WINDOW = 720.0  # m, after which the land repeats
SQUARE = 80.0  # m, a side of a square of field
STRETCH = 90.0  # m of road to a piece of roadside
RIGHT_EDGE, LEFT_EDGE, CENTRE = -1.75, 5.25, 1.75  # m, y of the lines of the road
_ROAD_FREE = 15.0  # m from the middle of the ridden lane in which no field stands


def stretch(variant: int, detail: Detail) -> Mesh:
    """A piece of roadside, `STRETCH` long: reflector posts, a row of trees, now and then a bush."""
    chance = np.random.default_rng(100 + variant)
    parts = []
    for x in (-30.0, 0.0, 30.0):
        parts += [post(detail).moved([x, y, 0]) for y in (RIGHT_EDGE - 1.1, LEFT_EDGE + 1.1)]
    for side, y0 in ((-1, RIGHT_EDGE - 5.0), (1, LEFT_EDGE + 5.0)):
        for x in (-34.0, -11.0, 12.0, 34.0):
            if chance.uniform() < 0.80:
                at = [x + chance.uniform(-4, 4), y0 + side * chance.uniform(0, 2.5), 0]
                parts.append(tree(chance, detail).moved(at))
            else:
                parts.append(bush(chance, detail).moved([x, y0 + side * 2, 0]))
    return joined(parts)


def field(variant: int, detail: Detail, *, road: bool) -> Mesh:
    """A square of land; where the `road` runs through it, its middle stays free."""
    chance = np.random.default_rng(200 + variant + 50 * road)
    parts: list[Mesh] = []
    kinds = (_copse, _farm, _hedge, _lone_trees, _orchard, _lone_trees, _hedge, _copse, _hamlet)
    parts += kinds[variant % len(kinds)](chance, detail, road)
    if detail.near:
        parts += _tufts(chance, road)
    return joined(parts)


def post(detail: Detail) -> Mesh:
    """A reflector post, 1 m high."""
    if not detail.near:
        return box([0, 0, 0.5], [0.05, 0.06, 0.5], Colour.POST)
    return joined(
        [
            box([0, 0, 0.36], [0.05, 0.06, 0.36], Colour.POST),
            box([0, 0, 0.81], [0.052, 0.062, 0.10], Colour.POST_BAND),
            box([0, 0, 0.82], [0.055, 0.030, 0.07], Colour.REFLECTOR),
            box([0, 0, 0.955], [0.05, 0.06, 0.045], Colour.POST),
        ]
    )


def house(chance: np.random.Generator, *, barn: bool = False) -> Mesh:
    """Walls, a gable roof along x, and on a dwelling a chimney, windows and a door."""
    a, b = (7.0, 4.2) if barn else (chance.uniform(4.5, 5.5), chance.uniform(3.3, 3.9))
    wall, ridge = (3.2, 7.0) if barn else (3.0, chance.uniform(6.2, 6.9))
    side = Colour.BARN if barn else (Colour.WALL, Colour.BRICK)[chance.integers(2)]
    roof = Colour.SLATE if barn else (Colour.ROOF, Colour.SLATE)[chance.integers(2)]
    parts = [box([0, 0, wall / 2], [a, b, wall / 2], side)]
    for x, sign in ((a, 1), (-a, -1)):
        gable = [[x, -sign * b, wall], [x, sign * b, wall], [x, 0, ridge]]
        parts.append(polygon(gable, side))
    out, slope = 0.45, (ridge - wall) / b
    low = wall - out * slope
    for s in (1, -1):
        edge = [[-a - out, s * (b + out), low], [a + out, s * (b + out), low]]
        top = [[a + out, 0, ridge + 0.05], [-a - out, 0, ridge + 0.05]]
        sheet = np.array([*edge, *top])
        parts += [polygon(sheet[::-1], roof), polygon(sheet - [0, 0, 0.10], roof)]
        if s < 0:
            parts[-2:] = [polygon(sheet, roof), polygon(sheet[::-1] - [0, 0, 0.10], roof)]
    if not barn:
        parts.append(box([0.5 * a, 0.3 * b, ridge], [0.35, 0.35, 0.8], Colour.BRICK))
    for s in (1, -1):
        for x in (-0.6 * a, 0.55 * a):
            parts.append(box([x, s * b, 1.6], [0.62, 0.04, 0.62], Colour.WINDOW))
        parts.append(box([-0.05 * a, s * b, 1.05], [0.5, 0.05, 1.05], Colour.DOOR))
        parts.append(box([s * a, 0.0, 1.7], [0.04, 0.7, 0.65], Colour.WINDOW))
    return joined(parts)


def _place(chance: np.random.Generator, road: bool) -> list[float]:
    """Anywhere in the square, but not on the road."""
    x = chance.uniform(-36, 36)
    y = chance.uniform(-36, 36)
    if road:
        y = math.copysign(chance.uniform(_ROAD_FREE + 5, 36), y)
    return [x, y, 0]


def _lone_trees(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    parts = [tree(chance, detail).moved(_place(chance, road)) for _ in range(3)]
    return [*parts, bush(chance, detail).moved(_place(chance, road))]


def _copse(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    middle = np.array(_place(chance, road))
    if road:
        middle[1] = math.copysign(30, middle[1])
    around = [middle + [*chance.uniform(-9, 9, 2), 0] for _ in range(7)]
    return [tree(chance, detail).moved(at) for at in around]


def _hedge(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    y = math.copysign(chance.uniform(26, 36), chance.uniform(-1, 1))
    last = tree(chance, detail).moved([chance.uniform(-30, 30), y, 0])
    step = 5.0 if detail.near else 10.0
    leaf = (Colour.LEAF_DARK, Colour.LEAF)[chance.integers(2)]
    row = [
        crown([x, y, 0.9], [0.62 * step, 1.2, 1.5], leaf, FAR, chance)
        for x in np.arange(-38, 39, step)
    ]
    return [*row, last]


def _orchard(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    y0 = 22.0 if road else -6.0
    parts = []
    for x in (-24.0, -12.0, 0.0, 12.0, 24.0):
        for y in (y0, y0 + 10.0):
            ball = crown([0, 0, 2.4], [1.5, 1.5, 1.3], Colour.LEAF_LIGHT, FAR, chance)
            stem = trunk(1.6, 0.10, Colour.BARK)
            parts.append(joined([ball, stem]).moved([x, y, 0]))
    return parts


def _farm(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    y = 29.0 if road else 5.0
    turn = _about_z(chance.uniform(-0.4, 0.4))
    return [
        house(chance).moved([-8, y, 0], turn),
        house(chance, barn=True).moved([11, y + 3, 0], turn @ _about_z(0.2)),
        tree(chance, detail).moved([-18, y + 4, 0]),
        tree(chance, detail).moved([0, y + 8, 0]),
        bush(chance, detail).moved([-12, y - 7, 0]),
    ]


def _hamlet(chance: np.random.Generator, detail: Detail, road: bool) -> list[Mesh]:
    y = -29.0 if road else -10.0
    return [
        house(chance).moved([-16, y, 0], _about_z(0.3)),
        house(chance).moved([4, y - 3, 0], _about_z(1.3)),
        tree(chance, detail).moved([14, y, 0]),
        tree(chance, detail).moved([-5, y + 7, 0]),
        bush(chance, detail).moved([22, y + 5, 0]),
    ]


def _tufts(chance: np.random.Generator, road: bool) -> list[Mesh]:
    """Speed can be felt on the open meadow, too."""
    parts = []
    for k in range(34):
        x, y = chance.uniform(-39, 39, 2)
        if not (road and RIGHT_EDGE - 1.5 < y < LEFT_EDGE + 1.5):
            colour = (Colour.LEAF, Colour.LEAF_LIGHT, Colour.BLOSSOM, Colour.LEAF)[k % 4]
            parts.append(tuft(chance, colour).moved([x, y, -0.02]))
    return parts


def _about_z(angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
