"""The faults of a bench that the host watches for, by the rows of the table in docs/bench.md."""

import re
from enum import IntEnum
from typing import Annotated, ClassVar, NamedTuple

from pydantic import Field

from bikesim.settings import Settings


class Reaction(IntEnum):
    """What a fault leads to; the higher the graver."""

    HOLD = 1
    """R1: the last torque is held; over when the fault is."""
    RAMP = 2
    """R2: the torque goes to zero in a short time, then the drive is disabled."""
    ZERO = 3
    """R3: zero torque and a disabled drive at once."""


class Fault(NamedTuple):
    """A fault that was seen: its row, what was seen (with value and unit), and what is allowed."""

    row: int
    what: str
    allowed: str
    reaction: Reaction

    def __str__(self) -> str:
        return f"fault {self.row}: {self.what}; allowed {self.allowed}"


class Observation(NamedTuple):
    """What a bench knows at a tick besides the sample: SI, right positive, ages in [s].

    `fresh`: whether there is a good sensor frame since the last tick, `sample_time` [s] its own on
    the node's clock; `age` of the newest. `drive_age`: how long the drive has owed its data.
    `bad_frames`, `frozen_frames`: in a row, up to now.
    `drive_trouble` and `bus_trouble` say what is wrong in words, or are empty; so is
    `drive_error`, what the drive itself reported. `late`: this tick, after the first deadline that
    it was to meet, and `skipped` how many it left out.
    """

    time: float
    steer: float
    steer_rate: float
    fresh: bool
    sample_time: float
    age: float
    bad_frames: int
    frozen_frames: int
    pot_ok: bool
    gyro_ok: bool
    vref_ok: bool
    estop_closed: bool
    drive_age: float
    drive_heartbeat_age: float
    drive_trouble: str
    drive_error: str
    torque_measured: float
    torque_sent: float
    late: float
    bus_trouble: str
    second_master: bool
    skipped: int = 0


# What a threshold may be: past any of these a fault would act too late to be one, or never.
_Age = Annotated[float, Field(gt=0, le=0.5)]
_Angle = Annotated[float, Field(gt=0, le=180)]
_Frames = Annotated[int, Field(ge=1, le=100)]
_Ticks = Annotated[int, Field(ge=1, le=1000)]


class Thresholds(Settings):
    """When something is a fault, and how the torque goes in and out. Times in [s]."""

    table: ClassVar[str] = "thresholds"

    hold_age: _Age = Field(default=0.003, description="Age of the sample: hold [s].")
    ramp_age: _Age = Field(default=0.010, description="Age of the sample: ramp out [s].")
    zero_age: _Age = Field(default=0.020, description="Age of the sample: zero at once [s].")
    bad_frames: _Frames = Field(default=3, description="Wrong checksums in a row: zero.")
    frozen_frames: _Frames = Field(default=3, description="Repeated or frozen in a row: zero.")
    slip_rate: Annotated[float, Field(gt=0, le=5)] = Field(
        default=0.5, description="Rate of the angle against the gyro's [rad/s]: zero."
    )
    slip_time: _Age = Field(default=0.020, description="For so long [s].")
    bias_angle: Annotated[float, Field(gt=0, le=0.5)] = Field(
        default=0.05, description="Angle against the gyro's leaky integral [rad]: ramp out."
    )
    bias_time: Annotated[float, Field(ge=0.2, le=20)] = Field(
        default=2.0, description="Time constant of that integral [s]."
    )
    angle_step: Annotated[float, Field(gt=0, le=0.2)] = Field(
        default=0.020, description="Angle in one tick [rad]: zero."
    )
    soft_stop_deg: _Angle = Field(
        default=35.0, description="From here on, less and less torque outwards [deg]."
    )
    trip_angle_deg: _Angle = Field(default=45.0, description="Steer angle: zero [deg].")
    trip_rate: Annotated[float, Field(gt=0, le=20)] = Field(
        default=8.0, description="Steer rate [rad/s]: zero."
    )
    trip_rate_time: Annotated[float, Field(gt=0, le=0.1)] = Field(
        default=0.002, description="For so long [s]."
    )
    saturated_time: Annotated[float, Field(gt=0, le=5)] = Field(
        default=0.5, description="At the torque limit for so long [s]: ramp out."
    )
    slewed_ticks: _Ticks = Field(default=20, description="Slewed in a row: ramp out.")
    thermal_time: Annotated[float, Field(gt=0, le=60)] = Field(
        default=10.0, description="Over which the torque's RMS is taken [s]."
    )
    cooled_time: Annotated[float, Field(gt=0, le=30)] = Field(
        default=5.0, description="Scaled down for so long [s]: ramp out."
    )
    drive_age: _Age = Field(default=0.005, description="Age of the drive's data [s]: zero.")
    drive_heartbeats: Annotated[float, Field(ge=1, le=20)] = Field(
        default=1.5, description="Age of its heartbeat in periods: zero."
    )
    follow_error: Annotated[float, Field(gt=0, le=5)] = Field(
        default=0.5, description="Torque measured against commanded [N m]: zero."
    )
    follow_time: _Age = Field(default=0.020, description="For so long [s].")
    late: Annotated[float, Field(gt=0, le=0.2)] = Field(
        default=0.001, description="A tick this late is an overrun, and feeds no watchdog [s]."
    )
    late_ticks: _Ticks = Field(default=20, description="Overruns in a row: ramp out.")
    late_most: Annotated[float, Field(gt=0, le=0.2)] = Field(
        default=0.020, description="A tick this late [s]: ramp out."
    )
    skipped_share: Annotated[float, Field(gt=0, lt=1)] = Field(
        default=0.1, description="Of the ticks of a second, left out as they were past: ramp out."
    )
    rest_torque: Annotated[float, Field(gt=0, le=1)] = Field(
        default=0.1, description="Measured before any is sent [N m], of noise: no enabling."
    )
    wheel_silent: Annotated[float, Field(gt=0, le=5)] = Field(
        default=0.5, description="No good speed for so long [s]; held until then: ramp out."
    )
    fall_roll_deg: Annotated[float, Field(gt=0, lt=90)] = Field(
        default=40.0, description="The rider fell [deg]: ramp out."
    )
    ramp_in: Annotated[float, Field(ge=0.01, le=60)] = Field(
        default=1.0, description="From no torque to all of it [s]."
    )
    ramp_out: Annotated[float, Field(gt=0, le=0.5)] = Field(
        default=0.1, description="From any torque to none [s]."
    )


# Of all others a larger figure is the weaker one.
_WEAKER_IF_LESS = ("bias_time", "ramp_in")


def weaker(thresholds: Thresholds) -> list[str]:
    """Those that let more happen than their defaults do, each with value, unit and default."""
    found: list[str] = []
    for name, field in Thresholds.model_fields.items():
        value, default = getattr(thresholds, name), field.default
        if (value < default) if name in _WEAKER_IF_LESS else (value > default):
            found.append(_beside(name, value, default, field.description or ""))
    return found


def _beside(name: str, value: float, default: float, description: str) -> str:
    """The unit is that of the description, but milliseconds for a time below one second."""
    bracket = re.search(r"\[(.+?)\]", description)
    unit = "" if bracket is None or name.endswith("_deg") else f" {bracket[1]}"
    if unit == " s" and default < 1:
        value, default, unit = 1e3 * value, 1e3 * default, " ms"
    return f"{name} {value:g}{unit} ({default:g})"
