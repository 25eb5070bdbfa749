"""A torque by the clock, whatever the bicycle does: every figure that a user may set."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from bikesim.errors import InputError
from bikesim.settings import Settings, of_kind

_Torque = Annotated[float, Field(ge=-1000, le=1000)]
_Time = Annotated[float, Field(ge=0, le=86400)]
_Frequency = Annotated[float, Field(gt=0, le=1e4)]
# TOML has lists, not tuples.
_List = Strict(False)
_Sample = Annotated[tuple[float, float], _List]

_BAND = {"lowest": 0.6, "highest": 20.0}
# The figures of each kind, with their defaults.
_KINDS: dict[str, dict[str, Any]] = {
    "step": {"torque": 1.0, "start": 1.0, "stop": None},
    "multisine": {
        "torque_rms": 0.5, "lines": 12, **_BAND, "repeat": 30.0, "phases": "schroeder", "seed": 0,
        "start": 0.0, "stop": None,
    },
    "chirp": {"torque": 1.0, **_BAND, "sweep": "logarithmic", "start": 0.0, "duration": 20.0},
    "file": {"file": None, "digest": None, "samples": (), "start": 0.0},
    "record": {"file": None, "digest": None, "inertia": None, "samples": (), "start": 0.0},
}  # fmt: skip
SCRIPT_KINDS = tuple(_KINDS)


class ScriptSettings(Settings):
    """The torque of a rider named torque-KIND: its figures, those of the other kinds None.

    Made from a `kind` alone it has the figures of that kind; those given beside it replace them.
    """

    table: ClassVar[str] = "rider.script"

    kind: Literal["step", "multisine", "chirp", "file", "record"] = Field(
        default="step", description="As in the rider's name: step, multisine, chirp, file, record."
    )
    torque: _Torque | None = Field(
        default=None,
        description="Of a step, and amplitude of a chirp, to the right [N m]; default: 1.",
    )
    torque_rms: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None, description="Of a multisine, root mean square [N m]; default: 0.5."
    )
    lines: Annotated[int, Field(ge=1, le=200)] | None = Field(
        default=None, description="Of a multisine, how many sines; default: 12."
    )
    lowest: _Frequency | None = Field(
        default=None,
        description="Lowest frequency of a multisine, first of a chirp [rad/s]; default: 0.6.",
    )
    highest: _Frequency | None = Field(
        default=None,
        description="Highest frequency of a multisine, last of a chirp [rad/s]; default: 20.",
    )
    repeat: Annotated[float, Field(gt=0, le=1e4)] | None = Field(
        default=None,
        description="After which a multisine repeats [s]: its frequencies are whole multiples of "
        "2π / repeat; default: 30.",
    )
    phases: Literal["schroeder", "random"] | None = Field(
        default=None,
        description="Of a multisine: schroeder (low peaks), or random by its seed; default: "
        "schroeder.",
    )
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = Field(
        default=None, description="Of a multisine's random phases; default: 0."
    )
    sweep: Literal["logarithmic", "linear"] | None = Field(
        default=None,
        description="How a chirp's frequency rises with time; default: logarithmic.",
    )
    start: _Time | None = Field(
        default=None, description="When it begins [s]; default: 0, of a step 1."
    )
    stop: _Time | None = Field(
        default=None, description="When a step or multisine ends [s]; default: with the run."
    )
    duration: Annotated[float, Field(gt=0, le=86400)] | None = Field(
        default=None, description="Of a chirp [s]; default: 20."
    )
    file: str | None = Field(
        default=None,
        description="Text file of columns time [s] and torque [N m]; of kind record a run file, "
        "or the CSV of another rig.",
    )
    inertia: Annotated[float, Field(gt=0, lt=1000)] | None = Field(
        default=None,
        description="Of kind record, I_δ of its bar [kg m²], where the torque follows from the "
        "bar's motion; default: that of the record.",
    )
    digest: str | None = Field(
        default=None,
        description="SHA-256 of the file, as a record has it: a file with another is refused; "
        "default: any file will do.",
    )
    samples: Annotated[tuple[_Sample, ...], _List] = Field(
        default=(), description="In place of a file: pairs of time [s] and torque [N m]."
    )

    @model_validator(mode="before")
    @classmethod
    def _by_kind(cls, given: Any) -> Any:
        if not isinstance(given, dict) or not isinstance(given.get("kind", "step"), str):
            return given
        given = {key: value for key, value in given.items() if value not in (None, (), [])}
        return of_kind({"kind": "step", **given}, cls, _KINDS)

    @model_validator(mode="after")
    def _can_be_played(self) -> "ScriptSettings":
        if self.kind in ("file", "record") and not self.file and not self.samples:
            raise InputError(f"rider.script.file: must be given for rider torque-{self.kind}")
        if self.stop is not None and self.start is not None and self.stop <= self.start:
            raise ValueError(f"stop = {self.stop} s: must come after start = {self.start} s")
        if self.kind in ("multisine", "chirp"):
            from bikesim.rider.scripted import check_band

            check_band(self)
        return self
