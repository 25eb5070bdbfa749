"""Pixels put on planes, and what a player makes of them."""

import av
import numpy as np
import pytest

from bikesim.view.canvas import PlanesCanvas, RgbCanvas, make_canvas
from bikesim.view.layout import Box

WIDTH, HEIGHT = 64, 48
WHOLE = Box(0, 0, WIDTH, HEIGHT)
COLOURS = ((0, 0, 0), (255, 255, 255), (230, 30, 20), (20, 190, 40), (30, 60, 220), (90, 90, 90))


def played(canvas: PlanesCanvas) -> np.ndarray:
    """As RGB, by FFmpeg."""
    frame = av.VideoFrame.from_ndarray(canvas.pixels, format="yuv420p")
    return frame.to_ndarray(format="rgb24", src_colorspace="ITU709").astype(int)


def stripes(width: int = WIDTH, height: int = HEIGHT) -> np.ndarray:
    picture = np.empty((height, width, 3), np.uint8)
    for part, colour in zip(np.array_split(picture, len(COLOURS)), COLOURS, strict=True):
        part[:] = colour
    return picture


@pytest.mark.parametrize("times", [1, 2, 0.5])
def test_colours_come_back_whatever_size_was_drawn(times: float):
    canvas = PlanesCanvas(WIDTH, HEIGHT)
    canvas.put(WHOLE, stripes(round(WIDTH * times), round(HEIGHT * times)))
    inside = np.arange(4, HEIGHT, HEIGHT // len(COLOURS))
    assert np.abs(played(canvas)[inside] - stripes()[inside].astype(int)).max() <= 4


def test_only_the_box_is_touched():
    canvas = PlanesCanvas(WIDTH, HEIGHT)
    canvas.put(WHOLE, stripes())
    before = played(canvas)
    canvas.fill(Box(10, 20, 30, 12), (240, 200, 30))
    after = played(canvas)
    assert np.abs(after[20:32, 10:40] - (240, 200, 30)).max() <= 4
    after[20:32, 10:40] = before[20:32, 10:40]
    assert (after[:18] == before[:18]).all()
    assert (after[34:] == before[34:]).all()
    assert (after[:, 42:] == before[:, 42:]).all()


def test_what_is_drawn_on_is_what_is_there_and_stays():
    canvas = PlanesCanvas(WIDTH, HEIGHT)
    canvas.put(WHOLE, stripes())
    before = canvas.pixels.copy()
    box = Box(8, 4, 20, 40)
    with canvas.drawing(box) as part:
        assert np.abs(part.astype(int) - played(canvas)[box.part]).max() <= 4
    assert np.abs(canvas.pixels.astype(int) - before).max() <= 1
    with canvas.drawing(box) as part:
        part[4:8] = 255
    assert played(canvas)[8:12, 8:28].min() > 250


@pytest.mark.parametrize("pixels", ["rgb24", "yuv420p"])
def test_half_the_light_is_half_of_each_colour(pixels: str):
    canvas = make_canvas(pixels, WIDTH, HEIGHT)
    canvas.put(WHOLE, stripes())
    canvas.darken(WHOLE, 0.5)
    seen = canvas.pixels if isinstance(canvas, RgbCanvas) else played(canvas)  # pyright: ignore[reportArgumentType]
    inside = np.arange(4, HEIGHT, HEIGHT // len(COLOURS))
    assert np.abs(seen[inside].astype(int) - 0.5 * stripes()[inside]).max() <= 4


def test_boxes_about_things_are_even_and_within():
    within = Box(100, 40, 60, 50)
    assert Box.about(3.2, 4.0, 5.1, 6.5, within) == Box(102, 44, 8, 8)
    assert Box.about(-9, 41, 200, 30, within) == Box(100, 80, 60, 10)
