"""Plates with a few lines of text for the live display, drawn again only when they change."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bikesim.view.drawing import BOLD, INK, REGULAR, WHITE, Colour, Picture, text_width, write


class Line(NamedTuple):
    """A line of a plate: its letters' size in pixels of a 720p picture."""

    text: str
    size: int = 22
    colour: Colour = WHITE
    bold: bool = False


def fitting(lines: tuple[Line, ...], unit: float, within: tuple[int, int]) -> Picture:
    """In the middle of each other, smaller where the window, width and height, is too small."""
    picture = plate(lines, unit, "middle")
    rows, columns = picture.shape[:2]
    share = min(0.96 * within[0] / columns, 0.6 * within[1] / rows)
    return picture if share >= 1 else plate(lines, unit * share, "middle")


@lru_cache(maxsize=64)
def plate(lines: tuple[Line, ...], unit: float, align: str = "left", least: float = 0) -> Picture:
    """Lines below each other; `unit`: pixels of the window for one of a 720p picture.

    At least as wide as `least` of those, so that one whose figures change stands still.
    """
    sizes = [max(8, round(line.size * unit)) for line in lines]
    weights = [BOLD if line.bold else REGULAR for line in lines]
    widths = [
        text_width(line.text, size, weight)
        for line, size, weight in zip(lines, sizes, weights, strict=True)
    ]
    edge = round(14 * unit)
    # Rows and columns in fours, as OpenGL's pixels come.
    width = 4 * math.ceil(max(max(widths) + 2 * edge, least * unit) / 4)
    height = round(sum(1.45 * size for size in sizes)) + round(1.3 * edge)
    picture = np.empty((height, width, 3), np.uint8)
    picture[:] = INK
    y = 0.65 * edge
    x = {"left": edge, "middle": width / 2, "right": width - edge}[align]
    for line, size, weight in zip(lines, sizes, weights, strict=True):
        write(picture, line.text, x, y + 1.08 * size, size, line.colour, weight, align)
        y += 1.45 * size
    return picture
