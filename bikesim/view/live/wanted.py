"""What a person may want of a live display."""

from typing import NamedTuple

from bikesim.errors import InputError
from bikesim.view.quality import Quality

SMALLEST, _LARGEST = (320, 180), 16384


class Wanted(NamedTuple):
    """What a person wants of a display; `quality` None: as good as the OpenGL is quick.

    `once`: it closes a little after the first ride is over.
    """

    view: str = "first"
    size: tuple[int, int] = (1280, 720)
    monitor: int | None = None
    full_screen: bool = False
    quality: Quality | None = None
    overlay: bool = True
    once: bool = False


def check_window_size(width: int, height: int) -> tuple[int, int]:
    """The size. Raises InputError for one that no window has."""
    if not (SMALLEST[0] <= width <= _LARGEST and SMALLEST[1] <= height <= _LARGEST):
        raise InputError(
            f"--size {width}x{height}: from {SMALLEST[0]}x{SMALLEST[1]} to {_LARGEST}x{_LARGEST} "
            "pixels"
        )
    return width, height
