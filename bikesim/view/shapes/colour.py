"""The colours of what is drawn as meshes: one small texture holds them all."""

from enum import Enum

import numpy as np
from numpy.typing import NDArray

_SWATCH = 4  # pixels a side, so that a filter at the middle of one colour never meets the next


class Colour(Enum):
    """A colour as red, green, blue from 0 to 1. The trailing number only tells equal ones apart."""

    FRAME = (0.05, 0.42, 0.50)
    FRAME_DARK = (0.04, 0.27, 0.34)
    STEEL = (0.74, 0.76, 0.79)
    ALUMINIUM = (0.86, 0.87, 0.88)
    RUBBER = (0.13, 0.13, 0.14)
    TYRE_WALL = (0.72, 0.60, 0.43)
    LEATHER = (0.47, 0.27, 0.15)
    SKIN = (0.90, 0.69, 0.56)
    JERSEY = (0.91, 0.42, 0.27)
    JERSEY_LIGHT = (0.97, 0.90, 0.82)
    TROUSERS = (0.17, 0.21, 0.31)
    SHOE = (0.93, 0.93, 0.91)
    SOLE = (0.30, 0.31, 0.33)
    HELMET = (0.96, 0.96, 0.95)
    HELMET_STRIPE = (0.07, 0.46, 0.54)
    HAIR = (0.27, 0.19, 0.14)
    LAMP = (0.86, 0.16, 0.14)

    BARK = (0.40, 0.32, 0.25)
    BIRCH = (0.83, 0.82, 0.78)
    LEAF = (0.37, 0.55, 0.26)
    LEAF_LIGHT = (0.50, 0.64, 0.30)
    LEAF_DARK = (0.29, 0.48, 0.27)
    FIR = (0.23, 0.41, 0.29)
    MEADOW = (0.55, 0.68, 0.34)
    BLOSSOM = (0.90, 0.82, 0.25)
    WALL = (0.93, 0.90, 0.84)
    BRICK = (0.66, 0.38, 0.30)
    BARN = (0.52, 0.25, 0.21)
    ROOF = (0.60, 0.29, 0.22)
    SLATE = (0.34, 0.36, 0.40)
    WINDOW = (0.33, 0.44, 0.52)
    DOOR = (0.24, 0.36, 0.33)
    POST = (0.95, 0.95, 0.94)
    POST_BAND = (0.16, 0.16, 0.17)
    REFLECTOR = (0.95, 0.45, 0.10)
    MARKING = (0.96, 0.96, 0.93)
    RIBBON = (0.99, 0.80, 0.17)


_ORDER = {colour: index for index, colour in enumerate(Colour)}


def palette() -> NDArray[np.uint8]:
    """The texture, shape (4, 4 n, 3)."""
    row = np.array([colour.value for colour in Colour])
    pixels = np.rint(255 * row).astype(np.uint8)
    return np.tile(np.repeat(pixels, _SWATCH, axis=0), (_SWATCH, 1, 1))


def texture_coordinate(colour: Colour) -> tuple[float, float]:
    """Where the palette has a colour."""
    return (_ORDER[colour] + 0.5) / len(_ORDER), 0.5
