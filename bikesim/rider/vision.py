"""What the display shows the rider: cues, delay, preview, and when it is dark."""

from itertools import pairwise
from typing import Annotated, ClassVar

from pydantic import Field, Strict, field_validator

from bikesim.settings import Settings

_Time = Annotated[float, Field(ge=0, le=86400)]
# TOML has lists, not tuples.
_List = Strict(False)
Interval = tuple[float, float]


class VisionSettings(Settings):
    """The rider's view of the bicycle and of the road before him."""

    table: ClassVar[str] = "vision"

    roll_cue: bool = Field(
        default=True,
        description="Whether the view rolls; if not, he sees a level horizon and no roll.",
    )
    preview: Annotated[float, Field(ge=0, le=60)] | None = Field(
        default=None,
        description="How much of the path before him he sees, in time of riding [s]; "
        "default: all of it.",
    )
    delay: Annotated[float, Field(ge=0, le=5)] = Field(
        default=0.0, description="Of the display [s]; comes on top of rider.visual_delay."
    )
    occlusions: Annotated[tuple[Annotated[tuple[_Time, _Time], _List], ...], _List] = Field(
        default=(),
        description="When the display is dark: pairs of times, from and to [s], rising. "
        "He goes on with what he saw last.",
    )

    @field_validator("occlusions")
    @classmethod
    def _in_order(cls, occlusions: tuple[Interval, ...]) -> tuple[Interval, ...]:
        for first, last in occlusions:
            if last <= first:
                raise ValueError(f"{[first, last]}: must end after it begins")
        for (_, end), (begin, _) in pairwise(occlusions):
            if begin < end:
                raise ValueError(f"must rise and not overlap, but {begin} comes after {end}")
        return occlusions
