"""What a run is: everything a user may set, validated; TOML in, TOML out."""

import re
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from bikesim import textfile
from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.files import beside
from bikesim.guard import GuardSettings
from bikesim.haptics import HapticsSettings, make_haptics
from bikesim.path.settings import PathSettings
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings
from bikesim.rig.settings import RigSettings
from bikesim.settings import Settings

_Time = Annotated[float, Field(ge=0, le=86400)]
_Speed = Annotated[float, Field(ge=0, le=30)]
_Arm = Annotated[float, Field(ge=-10, le=10)]
_Lean = Annotated[float, Field(gt=-90, lt=90)]
_Turn = Annotated[float, Field(ge=-360, le=360)]
# TOML has lists, not tuples.
_List = Strict(False)


class StartSettings(Settings):
    """The bicycle at the first tick."""

    table: ClassVar[str] = "start"

    roll_deg: _Lean = Field(default=0.0, description="Roll [deg].")
    roll_rate_deg_s: _Turn = Field(default=0.0, description="Roll rate [deg/s].")
    heading_deg: _Turn = Field(default=0.0, description="Heading [deg].")
    steer_deg: _Lean = Field(default=0.0, description="Steer, of a bar at rest [deg].")


class Push(Settings):
    """A lateral push on the rear frame: a half sine in time, of a given impulse."""

    table: ClassVar[str] = "pushes"

    time: _Time = Field(description="When it begins [s].")
    impulse: Annotated[float, Field(ge=-1e4, le=1e4)] = Field(
        description="Lateral impulse, to the right [N s]."
    )
    duration: Annotated[float, Field(ge=1e-3, le=100)] = Field(
        default=0.1, description="How long it lasts [s]."
    )
    height: _Arm = Field(default=0.9, description="Of its point above the ground [m].")
    ahead: _Arm = Field(default=0.3, description="Of its point before the rear contact [m].")


def _ideal_rig() -> RigSettings:
    # Not a plain default: the rig's file is to be read by who wants it, not by who imports this.
    return RigSettings()


LawName = Literal["paper", "momentum", "off"]


class Scenario(Settings):
    """A run. Every key has a default: an empty scenario is the default run."""

    bicycle: str = Field(
        default="benchmark", description="A bicycle by name, or the path of its file."
    )
    gravity: Annotated[float, Field(gt=0, le=30)] | None = Field(
        default=None, description="Gravity [m/s²]; default: that of the bicycle's source."
    )
    speed: _Speed = Field(default=3.5, description="Forward speed [m/s].")
    speed_profile: Annotated[tuple[Annotated[tuple[_Time, _Speed], _List], ...], _List] = Field(
        default=(),
        description="Pairs of time [s] and speed [m/s], linear between them; replaces speed.",
    )
    law: LawName = Field(
        default="paper",
        description="Haptic law: paper (eq. 4 and 6), momentum (exact), off (no feedback).",
    )
    haptics: HapticsSettings = Field(
        default=HapticsSettings(), description="What is made of the feedback torque."
    )
    vision: VisionSettings = Field(
        default=VisionSettings(), description="What the display shows the rider."
    )
    path: PathSettings = Field(
        default=PathSettings(), description="A kind of path, or a table with its figures."
    )
    rider: RiderSettings = Field(
        default=RiderSettings(),
        description="A rider by name, or a table with its figures.",
    )
    rig: RigSettings = Field(
        default_factory=_ideal_rig,
        description="A rig by name or file, or a table of its figures.",
    )
    duration: Annotated[float, Field(gt=0, le=86400)] = Field(
        default=30.0, description="Of the run [s]."
    )
    seed: Annotated[int, Field(ge=0, lt=2**63)] = Field(default=1, description="Seed of all noise.")
    period: Annotated[float, Field(ge=1e-4, le=0.1)] = Field(
        default=0.001, description="Of the loop [s]: 0.001 is 1 kHz."
    )
    physics_step: Annotated[float, Field(ge=1e-5, le=0.01)] = Field(
        default=0.0005,
        description="Of the virtual rig's physics [s]; the period is a multiple of it.",
    )
    start: StartSettings = Field(default=StartSettings(), description="The first tick.")
    pushes: Annotated[tuple[Push, ...], _List] = Field(
        default=(), description="Lateral pushes on the rear frame."
    )
    disturbances: Annotated[tuple[Disturbance, ...], _List] = Field(
        default=(), description="Multisine torques, gusts and wind."
    )
    guard: GuardSettings = Field(default=GuardSettings(), description="Limits.")

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        times = [time for time, _ in self.speed_profile]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError(f"speed_profile: times must rise from pair to pair, not {times}")
        if self.duration < self.period:
            raise ValueError(
                f"duration = {self.duration} s: must be at least one loop period, {self.period} s"
            )
        steer, stop = self.start.steer_deg, self.rig.steer_stop_deg
        if abs(steer) >= stop:
            raise ValueError(
                f"start.steer_deg = {steer}: must be within the rig's stops, {stop} deg each side"
            )
        for one in self.disturbances:
            if one.highest is not None and one.highest >= pi / self.period:
                raise ValueError(
                    f"disturbances.highest = {one.highest} rad/s: must be below "
                    f"{pi / self.period:.6g} rad/s, half the frequency of the loop"
                )
        make_haptics(self.haptics, self.period)
        return self

    @property
    def ticks(self) -> int:
        """Ticks of a whole run."""
        return max(1, round(self.duration / self.period))


def read_toml(path: Path) -> dict[str, Any]:
    """A scenario file's keys, not yet checked; files it names are sought beside it first.

    Raises InputError.
    """
    return beside(textfile.read_toml(path, "scenario"), path.parent)


def to_toml(scenario: Scenario) -> str:
    """The scenario with every figure that it has, as a file that runs it again."""
    import tomli_w

    text = tomli_w.dumps(scenario.model_dump(mode="json", exclude_none=True))
    # Pairs of numbers, of which a path may have thousands, a line each.
    return re.sub(r"\[\s+([-+.\de]+),\s+([-+.\de]+),\s+\]", r"[\1, \2]", text)
