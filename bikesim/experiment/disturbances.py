"""What disturbs the bicycle for a while: multisine torques, and wind from the side."""

from math import tau
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from bikesim.errors import InputError
from bikesim.settings import Settings, of_kind

_Time = Annotated[float, Field(ge=0, le=86400)]
_Frequency = Annotated[float, Field(gt=0, le=1e3)]
_Arm = Annotated[float, Field(ge=-10, le=10)]
_Wind = Annotated[float, Field(ge=0, le=50)]

_MULTISINE: dict[str, Any] = {
    "start": 0.0, "stop": None, "lines": 12, "lowest": 0.6, "highest": 20.0, "repeat": 30.0,
    "phases": "random",
}  # fmt: skip
_SIDE_AREA: dict[str, Any] = {"drag_area": 0.7, "height": 1.0, "ahead": 0.4}
# The figures of each kind, with their defaults.
_KINDS: dict[str, dict[str, Any]] = {
    "roll-multisine": {**_MULTISINE, "torque_rms": 5.0},
    "steer-multisine": {**_MULTISINE, "torque_rms": 0.5},
    "gust": {"start": 0.0, "duration": 2.0, "wind_peak": 5.0, **_SIDE_AREA},
    "wind": {"start": 0.0, "stop": None, "wind_rms": 1.0, "wind_length": 10.0, **_SIDE_AREA},
}


class Disturbance(Settings):
    """A disturbance: a kind, and the figures that one of that kind has, the rest None.

    roll-multisine and steer-multisine: a torque T_φ or T_δ of sines. gust: a side wind that swells
    and goes. wind: turbulence from the side.
    """

    table: ClassVar[str] = "disturbances"

    kind: str = Field(description="roll-multisine, steer-multisine, gust or wind.")
    start: _Time | None = Field(default=None, description="When it begins [s]; default: 0.")
    stop: _Time | None = Field(
        default=None, description="When it ends [s], not of a gust; default: with the run."
    )
    torque_rms: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None,
        description="Of a multisine, root mean square [N m]; default: roll 5, steer 0.5.",
    )
    lines: Annotated[int, Field(ge=1, le=200)] | None = Field(
        default=None, description="Of a multisine, how many sines; default: 12."
    )
    lowest: _Frequency | None = Field(
        default=None, description="Of a multisine, lowest frequency [rad/s]; default: 0.6."
    )
    highest: _Frequency | None = Field(
        default=None, description="Of a multisine, highest frequency [rad/s]; default: 20."
    )
    repeat: Annotated[float, Field(gt=0, le=1e4)] | None = Field(
        default=None,
        description="After which a multisine repeats [s]: its frequencies are whole multiples of "
        "2π / repeat; default: 30.",
    )
    phases: Literal["random", "schroeder"] | None = Field(
        default=None,
        description="Of a multisine: random (by the seed) or schroeder; default: random.",
    )
    duration: Annotated[float, Field(ge=0.05, le=1000)] | None = Field(
        default=None, description="Of a gust [s]; default: 2."
    )
    wind_peak: Annotated[float, Field(ge=-50, le=50)] | None = Field(
        default=None, description="Of a gust, strongest, blowing to the right [m/s]; default: 5."
    )
    wind_rms: _Wind | None = Field(
        default=None, description="Of the wind from the side, root mean square [m/s]; default: 1."
    )
    wind_length: Annotated[float, Field(ge=0.1, le=1e4)] | None = Field(
        default=None, description="Of the wind's turbulence, scale [m]; default: 10."
    )
    drag_area: Annotated[float, Field(gt=0, le=10)] | None = Field(
        default=None,
        description="Of bicycle and rider from the side, drag coefficient times area [m²]; "
        "default: 0.7.",
    )
    height: _Arm | None = Field(
        default=None, description="Of the wind's point above the ground [m]; default: 1."
    )
    ahead: _Arm | None = Field(
        default=None, description="Of that point before the rear contact [m]; default: 0.4."
    )

    @model_validator(mode="before")
    @classmethod
    def _by_kind(cls, given: Any) -> Any:
        if not isinstance(given, dict) or not isinstance(given.get("kind"), str):
            return given
        given = {key: value for key, value in given.items() if value is not None}
        return of_kind(given, cls, _KINDS)

    @model_validator(mode="after")
    def _can_be_made(self) -> "Disturbance":
        if self.stop is not None and self.start is not None and self.stop <= self.start:
            raise ValueError(f"stop = {self.stop} s: must come after start = {self.start} s")
        if self.lines is not None:
            harmonics(self)
        return self


def harmonics(multisine: Disturbance) -> list[int]:
    """The lines of a multisine, as multiples of 2π / repeat: rising, as even in the logarithm of
    the frequency as whole numbers can be. Raises InputError if so many do not fit.
    """
    s: Any = multisine  # the figures of a multisine are there
    if s.highest < s.lowest:
        raise InputError(
            f"disturbances.highest = {s.highest} rad/s: must be at least lowest = {s.lowest} rad/s"
        )
    base = tau / s.repeat
    chosen: list[int] = []
    for i in range(s.lines):
        wanted = s.lowest * (s.highest / s.lowest) ** (i / max(1, s.lines - 1))
        above = chosen[-1] + 1 if chosen else 1
        chosen.append(max(above, round(wanted / base)))
    if chosen[-1] > s.highest / base + 0.5:
        fit = max(0, int(s.highest / base + 0.5) - max(1, round(s.lowest / base)) + 1)
        raise InputError(
            f"disturbances.lines = {s.lines}: of the multiples of 2π / {s.repeat:g} s only {fit} "
            f"lie between {s.lowest:g} and {s.highest:g} rad/s"
        )
    return chosen
