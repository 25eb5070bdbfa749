"""A process that makes some of the frames of a film.

Reads a pickled `Order` from stdin and writes each frame as FRAME and its pixels.
Ends when nobody reads them any more.
"""

import os
import pickle
import sys
from typing import BinaryIO

import cv2

from bikesim.errors import InputError
from bikesim.view.compose import Composer
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
    try:
        composer = Composer(order.film, order.pixels)
    except InputError as error:
        _send(out, REFUSED, str(error).encode())
        return 1
    try:
        for number in order.frames:
            _send(out, FRAME, composer.frame(number).data)
    finally:
        composer.close()
    return 0


def _send(out: BinaryIO, kind: bytes, data: bytes | memoryview) -> None:
    out.write(kind)
    left = memoryview(data).cast("B")
    while left:
        left = left[out.write(left) :]


if __name__ == "__main__":
    sys.exit(main())
