"""What a rig is: its sensors, motor, friction and inertia, as figures with a source."""

import math
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, Field, model_validator

from bikesim.data import data_path
from bikesim.errors import unknown
from bikesim.settings import Settings
from bikesim.textfile import located, read_toml

_NotNegative = Annotated[float, Field(ge=0, le=100)]
_Noise = Annotated[float, Field(ge=0, le=10)]
_Bias = Annotated[float, Field(ge=-10, le=10)]
_Delay = Annotated[float, Field(ge=0, le=1)]


def _countable(resolution: float) -> float:
    if 0 < resolution < 1e-12:
        raise ValueError(f"{resolution}: must be 0 (none) or at least 1e-12")
    return resolution


_Resolution = Annotated[float, Field(ge=0, le=10), AfterValidator(_countable)]


class RigSettings(Settings):
    """A virtual rig. The defaults are the ideal one: exact sensors, a motor without limits.

    A figure that is None is not there: no limit, no filter, the inertia that the law asks for.
    Made from a `name` alone it has all figures of the rig of that name (or TOML file); those given
    beside the name replace them.
    """

    table: ClassVar[str] = "rig"

    name: str = Field(default="ideal", description="One that ships, or the path of a TOML file.")
    description: str = Field(
        default="", description="What rig this is, and where its figures come from."
    )
    inertia: Annotated[float, Field(ge=1e-4, le=1000)] | None = Field(
        default=None,
        description="Of all that turns about the axis [kg m²]; default: what the law asks.",
    )
    rotor_inertia: _NotNegative = Field(
        default=0.0,
        description="Part of it that is the motor's rotor, seen through the gear [kg m²].",
    )
    coulomb_friction: _NotNegative = Field(default=0.0, description="At the steer axis [N m].")
    viscous_friction: _NotNegative = Field(
        default=0.0, description="At the steer axis [N m s/rad]."
    )
    steer_stop_deg: Annotated[float, Field(gt=1, le=180)] = Field(
        default=60.0, description="Mechanical stop, each side [deg]."
    )

    angle_resolution: _Resolution = Field(
        default=0.0, description="One count of the steer angle [rad]."
    )
    angle_noise: _Noise = Field(default=0.0, description="Standard deviation, white [rad].")
    angle_bias: _Bias = Field(default=0.0, description="Offset of the steer angle [rad].")
    rate_resolution: _Resolution = Field(
        default=0.0, description="One count of the steer rate [rad/s]."
    )
    rate_noise: _Noise = Field(default=0.0, description="Standard deviation, white [rad/s].")
    rate_bias: _Bias = Field(default=0.0, description="Offset of the steer rate [rad/s].")
    sensor_interval: _Delay = Field(
        default=0.0,
        description="Time between two sensor values [s]; 0: a new one at every physics step.",
    )
    sensor_delay: _Delay = Field(
        default=0.0, description="Age of a sensor value when it is read [s]."
    )
    filter_cutoff: Annotated[float, Field(ge=0.01, le=1e5)] | None = Field(
        default=None, description="Low pass on angle and rate alike, -3 dB [rad/s]; default: none."
    )
    filter_order: Annotated[int, Field(ge=1, le=4)] = Field(
        default=2, description="Butterworth order."
    )

    torque_limit: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None, description="Of motor and drive, at the steer axis [N m]; default: none."
    )
    torque_resolution: _Resolution = Field(
        default=0.0, description="One count of the command [N m]."
    )
    motor_lag: _Delay = Field(default=0.0, description="Time constant from command to torque [s].")
    motor_delay: _Delay = Field(default=0.0, description="Dead time from command to torque [s].")

    def __hash__(self) -> int:
        return hash(tuple(self.__dict__.values()))

    @property
    def steer_stop(self) -> float:
        """Mechanical stop, each side [rad]."""
        return math.radians(self.steer_stop_deg)

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, given: Any) -> Any:
        if isinstance(given, str):
            given = {"name": given}
        if isinstance(given, dict) and isinstance(given.get("name", "ideal"), str):
            return {**cls._named(given.get("name", "ideal")), **given}
        return given

    @classmethod
    def _named(cls, name: str) -> dict[str, Any]:
        keys = _read_rig(name)
        if Path(name).suffix == ".toml":
            # What is wrong in the file is to be told with its name.
            with located(f"rig {name}"):
                cls(**{**keys, "name": "ideal"})
        return keys


def rig_names() -> tuple[str, ...]:
    """The rigs that ship, by name."""
    return tuple(sorted(path.stem for path in data_path("hardware", "rigs").glob("*.toml")))


def _read_rig(name: str) -> dict[str, Any]:
    """The keys of a rig by name, or of a TOML file by its path. Raises InputError."""
    path = Path(name)
    if path.suffix != ".toml":
        if name not in rig_names():
            raise unknown("rig", name, rig_names())
        path = data_path("hardware", "rigs", f"{name}.toml")
    return read_toml(path, "rig")
