"""What frames are put together on: RGB for stills, or at once the planes that an encoder takes.

A frame of a video is mostly one picture, which changes as a whole, with a few small things over it.
On planes the picture is taken apart at the size at which it was drawn, which may be smaller; only
where something is drawn over it does a part become RGB again, and then planes.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from bikesim.view.drawing import Colour, Picture, darken
from bikesim.view.layout import Box

Pixels = NDArray[np.uint8]

# BT.709, HD's own: the shares of red, green and blue in Y. U is blue less Y, V red less Y.
_LIGHT = np.array([0.2126, 0.7152, 0.0722])
_DARKEST, _LIGHT_RANGE, _NO_COLOUR, _COLOUR_RANGE = 16, 219, 128, 224  # of 255: limited range


class Canvas(Protocol):
    """A frame, `pixels`. What is drawn stays in the next one until something is drawn over it.

    The edges of all boxes are even numbers, but where the frame's own are not.
    """

    pixels: Pixels

    def put(self, box: Box, picture: Picture) -> None:
        """A picture, made as large as the box."""
        ...

    def drawing(self, box: Box) -> AbstractContextManager[Picture]:
        """What is in a box, to draw on."""
        ...

    def fill(self, box: Box, colour: Colour) -> None:
        """One colour."""
        ...

    def darken(self, box: Box, factor: float) -> None:
        """Leaves a share of the light."""
        ...


def make_canvas(pixels: str, width: int, height: int) -> Canvas:
    """For a format of pixels, "rgb24" or "yuv420p"."""
    return RgbCanvas(width, height) if pixels == "rgb24" else PlanesCanvas(width, height)


class RgbCanvas:
    """Pixels (height, width, 3)."""

    def __init__(self, width: int, height: int) -> None:
        self.pixels: Pixels = np.zeros((height, width, 3), np.uint8)

    def put(self, box: Box, picture: Picture) -> None:
        _resized(picture, self.pixels[box.part])

    @contextmanager
    def drawing(self, box: Box) -> Iterator[Picture]:
        yield self.pixels[box.part]

    def fill(self, box: Box, colour: Colour) -> None:
        self.pixels[box.part] = colour

    def darken(self, box: Box, factor: float) -> None:
        darken(self.pixels[box.part], factor)


class PlanesCanvas:
    """Planes Y, U, V of 4:2:0, BT.709 in limited range, one below the other as FFmpeg has them."""

    def __init__(self, width: int, height: int) -> None:
        """Both even."""
        self.pixels: Pixels = np.zeros((height * 3 // 2, width), np.uint8)
        self._light = self.pixels[:height]
        self._colours = self.pixels[height:].reshape(2, height // 2, width // 2)

    def put(self, box: Box, picture: Picture) -> None:
        if picture.shape[0] > box.height:
            picture = cv2.resize(picture, (box.width, box.height), interpolation=cv2.INTER_AREA)  # pyright: ignore[reportAssignmentType]
        planes = cv2.transform(picture, _TO_PLANES)
        light, *colours = self._planes(box)
        _resized(cv2.extractChannel(planes, 0), light)
        for k, plane in enumerate(colours, start=1):
            _resized(cv2.extractChannel(planes, k), plane)

    @contextmanager
    def drawing(self, box: Box) -> Iterator[Picture]:
        size = (box.width, box.height)
        light, *colours = self._planes(box)
        whole = [cv2.resize(c, size, interpolation=cv2.INTER_NEAREST) for c in colours]
        picture = cv2.transform(cv2.merge([light, *whole]), _TO_RGB)
        yield picture  # pyright: ignore[reportReturnType]
        self.put(box, picture)  # pyright: ignore[reportArgumentType]

    def fill(self, box: Box, colour: Colour) -> None:
        planes = cv2.transform(np.array([[colour]], np.uint8), _TO_PLANES)
        for plane, value in zip(self._planes(box), planes[0, 0], strict=True):
            plane[:] = value

    def darken(self, box: Box, factor: float) -> None:
        for plane, zero in zip(self._planes(box), _BLACK, strict=True):
            cv2.convertScaleAbs(plane, dst=plane, alpha=factor, beta=(1 - factor) * zero)

    def _planes(self, box: Box) -> tuple[Pixels, Pixels, Pixels]:
        half = Box(*(edge // 2 for edge in box)).part
        return self._light[box.part], self._colours[0][half], self._colours[1][half]


def _resized(picture: NDArray[Any], into: Picture) -> None:
    """A picture into another one of any size."""
    size = (into.shape[1], into.shape[0])
    if picture.shape == into.shape:
        into[:] = picture
        return
    how = cv2.INTER_AREA if picture.shape[0] > into.shape[0] else cv2.INTER_LINEAR
    cv2.resize(picture, size, dst=into, interpolation=how)


def _to_planes() -> NDArray[np.float32]:
    """Rows Y, U, V of red, green, blue and 1."""
    light = _LIGHT * (_LIGHT_RANGE / 255)
    blue, red = (
        (np.eye(3)[k] - _LIGHT) / (2 * (1 - _LIGHT[k])) * (_COLOUR_RANGE / 255) for k in (2, 0)
    )
    return np.column_stack([[light, blue, red], _BLACK]).astype(np.float32)


def _to_rgb() -> NDArray[np.float32]:
    """The other way round."""
    back = np.linalg.inv(_TO_PLANES[:, :3].astype(float))
    return np.column_stack([back, -back @ _BLACK]).astype(np.float32)


_BLACK = (_DARKEST, _NO_COLOUR, _NO_COLOUR)
_TO_PLANES = _to_planes()
_TO_RGB = _to_rgb()
