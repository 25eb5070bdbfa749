"""A process that makes some of the frames of a film.

Reads a pickled `Order` from stdin and writes each frame as FRAME and its pixels.
Ends when nobody reads them any more.
"""

import os
import pickle
import sys
from collections.abc import Callable
from typing import BinaryIO

import cv2
import numpy as np

from bikesim.errors import InputError
from bikesim.view.compose import Composer
from bikesim.view.drawing import Picture
from bikesim.view.order import FRAME, REFUSED, Order


def main() -> int:
    """Exit status 1 if the film cannot be made here; the reason has been sent."""
    # What libraries print must not get among the frames.
    with os.fdopen(os.dup(1), "wb", buffering=0) as out:
        os.dup2(2, 1)
        order: Order = pickle.load(sys.stdin.buffer)
        cv2.setNumThreads(1)
        try:
            return _make(order, out)
        except BrokenPipeError:
            return 0


def _make(order: Order, out: BinaryIO) -> int:
    convert = converter(order.pixels)
    try:
        composer = Composer(order.film)
    except InputError as error:
        _send(out, REFUSED, str(error).encode())
        return 1
    try:
        for number in order.frames:
            _send(out, FRAME, convert(composer.frame(number)))
    finally:
        composer.close()
    return 0


def _send(out: BinaryIO, kind: bytes, data: bytes | memoryview) -> None:
    out.write(kind)
    left = memoryview(data).cast("B")
    while left:
        left = left[out.write(left) :]


def converter(pixels: str) -> Callable[[Picture], memoryview]:
    """From RGB to what an encoder takes: HD's own matrix, BT.709 in limited range, for YUV."""
    if pixels == "rgb24":
        return lambda picture: np.ascontiguousarray(picture).data
    import av
    from av.video.reformatter import ColorRange, Colorspace, VideoReformatter

    reformatter = VideoReformatter()

    def convert(picture: Picture) -> memoryview:
        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        made = reformatter.reformat(
            frame,
            format=pixels,
            dst_colorspace=Colorspace.ITU709,
            src_color_range=ColorRange.JPEG,
            dst_color_range=ColorRange.MPEG,
            threads=1,
        )
        return np.ascontiguousarray(made.to_ndarray()).data

    return convert


if __name__ == "__main__":
    sys.exit(main())
