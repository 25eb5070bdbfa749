"""Riders by name, and every figure of a rider that a user may set."""

from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from bikesim.errors import InputError, unknown
from bikesim.settings import Settings

_Gain = Annotated[float, Field(ge=-1e4, le=1e4)]


class RiderSettings(Settings):
    """A virtual rider: a name, and every figure that a rider of that name has, the rest None.

    Made from a `name` alone it has the figures of the rider of that name; those given beside the
    name replace them.
    """

    table: ClassVar[str] = "rider"

    name: str = Field(
        default="human",
        description="human, pd, hands-off, or schwab2013-RUN with the number of an identified run.",
    )
    roll_gain: _Gain | None = Field(default=None, description="k_phi of human and pd [N m/rad].")
    roll_rate_gain: _Gain | None = Field(
        default=None, description="k_phi_dot of human and pd [N m s/rad]."
    )
    visual_delay: Annotated[float, Field(ge=0, le=5)] | None = Field(
        default=None,
        description="From seeing to intending, human and pd [s]; published: 0.10 to 0.56.",
    )
    muscle_frequency: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None, description="Neuromuscular natural frequency [rad/s]."
    )
    muscle_damping_ratio: Annotated[float, Field(gt=0, le=10)] | None = Field(
        default=None, description="Neuromuscular damping ratio."
    )
    arm_inertia: Annotated[float, Field(ge=0, le=10)] | None = Field(
        default=None, description="Arms about the steer axis [kg m²]."
    )
    arm_damping: Annotated[float, Field(ge=0, le=1000)] | None = Field(
        default=None, description="Arms about the steer axis [N m s/rad]."
    )
    arm_stiffness: Annotated[float, Field(ge=0, le=1e4)] | None = Field(
        default=None, description="Arms about the steer axis [N m/rad]."
    )
    remnant_rms: Annotated[float, Field(ge=0, le=100)] | None = Field(
        default=None, description="Torque noise, root mean square [N m]."
    )
    remnant_bandwidth: Annotated[float, Field(gt=0, le=1e4)] | None = Field(
        default=None, description="Torque noise, corner of its spectrum [rad/s]."
    )

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, given: Any) -> Any:
        if isinstance(given, str):
            given = {"name": given}
        if not isinstance(given, dict) or not isinstance(given.get("name", "human"), str):
            return given
        given = {key: value for key, value in given.items() if value is not None}
        name = given.get("name", "human")
        preset = _preset(name)
        for key in given:
            if key in cls.model_fields and key not in ("name", *preset):
                raise InputError(
                    f"rider.{key} = {given[key]!r}: rider {name} has no such figure; "
                    f"it has: {', '.join(preset) or 'none'}"
                )
        return {**preset, **given}


_MUSCLE_H12 = {"muscle_frequency": 30.0, "muscle_damping_ratio": 0.707}  # [H12]
# [S13]: ω = 2π 2.17 rad/s, ζ = 1/√2.
_MUSCLE_S13 = {"muscle_frequency": 13.634512116579973, "muscle_damping_ratio": 0.7071067811865476}
_NO_ARMS = {"arm_inertia": 0.0, "arm_damping": 0.0, "arm_stiffness": 0.0}
_NO_NOISE = {"remnant_rms": 0.0, "remnant_bandwidth": 10.0}

# Arms and delay of the case that separates best: haptics on a roll PD balances, off none does
# (docs/paper.md). The gains are for the benchmark bicycle at 3.5 m/s: those with the least roll for
# a given remnant, which is chosen so that this roll is about 2 degrees RMS.
_HUMAN = {
    "roll_gain": 0.43,
    "roll_rate_gain": 1.74,
    "visual_delay": 0.2,
    **_MUSCLE_H12,
    "arm_inertia": 0.1,
    "arm_damping": 2.0,
    "arm_stiffness": 5.0,
    "remnant_rms": 0.03,
    "remnant_bandwidth": 10.0,
}
# The same arms, without delay and noise, for a researcher to start from; at home there too.
_PD = {**_HUMAN, "roll_gain": 3.0, "roll_rate_gain": 5.0, "visual_delay": 0.0, **_NO_NOISE}
_IDENTIFIED = "schwab2013-"


def rider_names() -> tuple[str, ...]:
    """Every rider's name; the identified ones by run number."""
    from bikesim.rider.schwab2013 import IDENTIFIED_RUNS

    return ("human", "pd", "hands-off", *(f"{_IDENTIFIED}{run.run}" for run in IDENTIFIED_RUNS))


def identified_run(name: str) -> int | None:
    """The run number in the name of an identified rider, else None."""
    number = name.removeprefix(_IDENTIFIED)
    return int(number) if name.startswith(_IDENTIFIED) and number.isdecimal() else None


def _preset(name: str) -> dict[str, Any]:
    match name:
        case "human":
            return _HUMAN
        case "pd":
            return _PD
        case "hands-off":
            return {}
    if identified_run(name) is not None and name in rider_names():
        return {**_MUSCLE_S13, **_NO_ARMS, **_NO_NOISE}
    raise unknown("rider", name, rider_names())
