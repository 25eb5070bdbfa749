"""What a drawing process is told, and how it answers."""

from dataclasses import dataclass

from bikesim.view.film import Film

# One byte before each answer: the pixels of a frame, or why there are none.
FRAME, REFUSED = b"F", b"R"


@dataclass(frozen=True, eq=False)
class Order:
    """Which frames of a film a process makes, in this order, and in which format of pixels."""

    film: Film
    frames: tuple[int, ...]
    pixels: str  # "rgb24" or "yuv420p"
