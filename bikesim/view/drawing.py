"""Text, plates and lines in pictures. Pictures are RGB, uint8, height x width x 3."""

from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
Colour = tuple[int, int, int]

# Okabe & Ito's, as in our figures; white where those have black.
SKY, VERMILION, ORANGE, GREEN = (86, 180, 233), (240, 110, 40), (240, 170, 20), (40, 190, 140)
WHITE, GREY, DARK, INK = (255, 255, 255), (150, 156, 163), (52, 58, 66), (18, 22, 27)

REGULAR, BOLD = 420, 640
_SHIFT = 4  # bits of a fraction of a pixel


@cache
def _font() -> Any:
    return cv2.FontFace("sans")


@cache
def text_width(text: str, size: int, weight: int = REGULAR) -> int:
    """In pixels; digits are counted as the widest of them, so that a running number stays put."""
    wide = "".join("0" if letter.isdigit() else letter for letter in text)
    _, _, width, _ = cv2.getTextSize((8192, 1024), wide, (0, 512), _font(), size, weight)
    return int(width)


def write(
    picture: Picture,
    text: str,
    x: float,
    y: float,
    size: int,
    colour: Colour = WHITE,
    weight: int = REGULAR,
    align: str = "left",
) -> None:
    """Text with its baseline at y and, as `align` says, its left end, middle or right end at x."""
    if align != "left":
        x -= text_width(text, size, weight) * (0.5 if align == "middle" else 1.0)
    cv2.putText(picture, text, (round(x), round(y)), colour, _font(), size, weight)


def darken(picture: Picture, factor: float) -> None:
    """In place."""
    cv2.convertScaleAbs(picture, dst=picture, alpha=factor)


def plate(picture: Picture, x: float, y: float, width: float, height: float, radius: float) -> None:
    """A dark translucent plate with round corners to read text on."""
    left, top = max(0, round(x)), max(0, round(y))
    behind = picture[top : round(y + height), left : round(x + width)]
    if behind.size:
        alpha = _plate_alpha(behind.shape[1], behind.shape[0], round(radius))
        cv2.multiply(behind, alpha, dst=behind, scale=1 / 255)


@cache
def _plate_alpha(width: int, height: int, radius: int) -> Picture:
    """What is left of the light behind a plate, of 255."""
    mask = np.full((height, width, 3), 255, np.uint8)
    left = (95, 95, 95)
    r = max(0, min(radius, width // 2 - 1, height // 2 - 1))
    cv2.rectangle(mask, (r, 0), (width - r - 1, height - 1), left, -1)
    cv2.rectangle(mask, (0, r), (width - 1, height - r - 1), left, -1)
    for x in (r, width - r - 1):
        for y in (r, height - r - 1):
            cv2.circle(mask, (x, y), r, left, -1, cv2.LINE_AA)
    return mask


def line(picture: Picture, points: NDArray[np.float64], colour: Colour, thickness: float) -> None:
    """A smooth line through points (n, 2) in pixels, clipped at the picture's edges."""
    fixed = np.round(np.clip(points, -8192, 8192) * (1 << _SHIFT)).astype(np.int32)
    width = max(1, round(thickness))
    cv2.polylines(picture, [fixed], False, colour, width, cv2.LINE_AA, _SHIFT)


def dot(picture: Picture, x: float, y: float, radius: float, colour: Colour) -> None:
    """A filled circle."""
    one = 1 << _SHIFT
    place = (round(x * one), round(y * one))
    cv2.circle(picture, place, round(radius * one), colour, -1, cv2.LINE_AA, _SHIFT)


def fill(picture: Picture, x: float, y: float, width: float, height: float, colour: Colour) -> None:
    """A rectangle with edges to a fraction of a pixel across."""
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    fixed = np.round(np.array(corners) * (1 << _SHIFT)).astype(np.int32)
    cv2.fillConvexPoly(picture, fixed, colour, cv2.LINE_AA, _SHIFT)
