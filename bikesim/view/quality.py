"""How much work goes into a picture."""

from enum import StrEnum
from typing import NamedTuple


class Quality(StrEnum):
    """A user's choice."""

    DRAFT = "draft"
    GOOD = "good"
    BEST = "best"


class Effort(NamedTuple):
    """What a quality means: anti-aliasing samples, side of the shadow map (0: no shadows), pixels
    drawn for one of the picture in each direction, and how round round things are drawn."""

    samples: int
    shadows: int
    scale: float
    roundness: int


EFFORTS = {
    Quality.DRAFT: Effort(samples=0, shadows=0, scale=0.5, roundness=12),
    Quality.GOOD: Effort(samples=4, shadows=2048, scale=1.0, roundness=24),
    Quality.BEST: Effort(samples=4, shadows=4096, scale=2.0, roundness=32),
}


def drawn_size(width: int, height: int, quality: Quality) -> tuple[int, int]:
    """The pixels that are drawn for a picture of a size."""
    scale = EFFORTS[quality].scale
    return max(1, round(width * scale)), max(1, round(height * scale))
