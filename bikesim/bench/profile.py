"""A bench as a file: bus, devices, bar, limits and thresholds, validated."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, Strict, model_validator

from bikesim.bench.bus import BusSettings
from bikesim.bench.drives import DriveSettings
from bikesim.bench.faults import Thresholds
from bikesim.bench.guard import TorqueLimits
from bikesim.bench.wheel_node import WheelSettings
from bikesim.data import data_path
from bikesim.errors import unknown
from bikesim.settings import Settings
from bikesim.textfile import located, read_toml

_Figure = Annotated[float, Field(ge=0, le=100)]
_Count = Annotated[int, Field(ge=-(2**31) + 1, le=2**31 - 1)]
_Calibration = Annotated[tuple[_Count, ...], Field(min_length=5, max_length=5), Strict(False)]
_SENSOR_NODES = (8, 9)  # of an ODrive: node × 0x20 on are its identifiers


class BarSettings(Settings):
    """The handlebar as identified, with everything that turns with it, the rider's arms not."""

    table: ClassVar[str] = "bar"

    inertia: Annotated[float, Field(ge=1e-4, le=100)] = Field(
        description="I_delta about the steer axis [kg m²], motor and gear included."
    )
    coulomb_friction: _Figure = Field(default=0.0, description="At the steer axis [N m].")
    viscous_friction: _Figure = Field(default=0.0, description="At the steer axis [N m s/rad].")
    steer_stop_deg: Annotated[float, Field(gt=1, le=180)] = Field(
        default=60.0, description="Mechanical stop, each side [deg]."
    )
    delay: Annotated[float, Field(ge=0, le=0.5)] = Field(
        description="From the bar's motion to torque, all in all [s]; bench identify measures it."
    )
    filter_cutoff: Annotated[float, Field(ge=1, le=1e5)] | None = Field(
        default=None,
        description="Of the node's low pass [rad/s], -3 dB, where delay does not contain it.",
    )
    filter_order: Annotated[int, Field(ge=1, le=4)] = Field(
        default=2, description="Of that low pass (Butterworth)."
    )
    drive_lag: Annotated[float, Field(ge=0, le=0.05)] = Field(
        default=0.0,
        description="From the torque told to that given, a time constant [s], where delay does not "
        "contain it.",
    )
    sensor_interval: Annotated[float, Field(ge=0, le=0.05)] = Field(
        default=0.0, description="Between two sensor values [s], where longer than the period."
    )
    source: Literal["node", "drive"] = Field(
        default="node", description="Of steer angle and rate: the sensor node, or the drive."
    )
    drive_zero: Annotated[float, Field(ge=-1e6, le=1e6)] = Field(
        default=0.0, description="What the drive's encoder says of a straight bar [rad]."
    )
    calibration: _Calibration | None = Field(
        default=None,
        description="That the sensor node must have: zero and scale of potentiometer and gyro, "
        "reference voltage, as it counts them; bench calibrate writes it. Default: not checked.",
    )
    coupling: Annotated[float, Field(ge=0, le=0.95)] = Field(
        default=0.0,
        description="Virtual inertia, of the part of I_delta that the bar lacks; 0: none.",
    )


class BenchSettings(Settings):
    """A bench profile. What a bench must be known by has no default: nothing is guessed."""

    description: str = Field(default="", description="What bench this is, and since when.")
    commissioned: str = Field(
        default="",
        description="Which bus, bar and drive passed the commissioning pulse: bench check --pulse.",
    )
    period: Annotated[float, Field(ge=5e-4, le=0.02)] = Field(
        default=0.001, description="Of the loop [s]."
    )
    bus: BusSettings = Field(description="The CAN bus.")
    bar: BarSettings = Field(description="The handlebar.")
    drive: Annotated[DriveSettings, Field(discriminator="kind")] = Field(
        description="The motor and its drive."
    )
    wheel: WheelSettings | None = Field(
        default=None, description="The speed sensor; default: none, the speed is the scenario's."
    )
    limits: TorqueLimits = Field(default=TorqueLimits(), description="Of the torque.")
    thresholds: Thresholds = Field(default=Thresholds(), description="Of the faults.")

    @property
    def commissioning(self) -> str:
        """What `commissioned` is once the pulse has proven signs, units and inertia as they are.

        With `bar.calibration`, which the sensor node must have when a ride begins.
        """
        bus = self.bus.model_dump(include={"interface", "channel", "arguments"})
        drive = self.drive.model_dump(exclude={"torque_limit", "speed_limit"})
        proven = {
            "bus": bus,
            "drive": drive,
            "inertia": self.bar.inertia,
            "source": self.bar.source,
            "calibration": self.bar.calibration,
        }
        text = json.dumps(proven, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:12]

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        if self.limits.torque > self.drive.torque_limit + 1e-9:
            raise ValueError(
                f"limits.torque = {self.limits.torque} N m: is more than drive.torque_limit = "
                f"{self.drive.torque_limit} N m, to which the drive itself keeps"
            )
        if self.limits.continuous_torque > self.limits.torque:
            raise ValueError(
                f"limits.continuous_torque = {self.limits.continuous_torque} N m: is more than "
                f"limits.torque = {self.limits.torque} N m"
            )
        self._check_nameplate()
        self._check_identifiers()
        if self.bar.source == "drive" and self.bar.delay < self.period:
            raise ValueError(
                f"bar.delay = {self.bar.delay} s: is less than the period, {self.period} s, by "
                'which data of the drive is late (bar.source = "drive")'
            )
        t = self.thresholds
        if not t.hold_age < t.ramp_age < t.zero_age:
            raise ValueError("thresholds: hold_age, ramp_age and zero_age must rise, in this order")
        if not t.late <= t.late_most <= self.drive.watchdog:
            raise ValueError(
                f"thresholds: late = {t.late} <= late_most = {t.late_most} <= "
                f"{self.drive.watchdog} must hold, the drive's watchdog [s], as nobody feeds it "
                "meanwhile"
            )
        if not t.soft_stop_deg < t.trip_angle_deg <= self.bar.steer_stop_deg:
            raise ValueError(
                f"thresholds: soft_stop_deg = {t.soft_stop_deg} < trip_angle_deg = "
                f"{t.trip_angle_deg} <= bar.steer_stop_deg = {self.bar.steer_stop_deg} must hold"
            )
        return self

    def _check_nameplate(self) -> None:
        """An ODrive knows no rating to hold the continuous torque against."""
        if self.drive.kind != "cia402":
            return
        rated, wanted = self.drive.rated_torque * self.drive.gear, self.limits.continuous_torque
        if wanted > rated * (1 + 1e-9):
            raise ValueError(
                f"limits.continuous_torque = {wanted} N m: is more than the nameplate's, "
                f"drive.rated_torque × drive.gear = {rated:.4g} N m"
            )

    def _check_identifiers(self) -> None:
        if self.drive.kind != "odrive" or self.drive.node not in _SENSOR_NODES:
            return
        if self.bar.source == "node" or self.wheel is not None:
            raise ValueError(
                f"drive.node = {self.drive.node}: has identifiers of the sensor nodes (0x100 to "
                "0x13F), of which this bench has one; any other from 0 to 62 will do"
            )


def bench_names() -> tuple[str, ...]:
    """The profiles that ship, by name."""
    return tuple(sorted(path.stem for path in data_path("hardware", "benches").glob("*.toml")))


def bench_path(name: str) -> Path:
    """Of a profile by name or path. Raises InputError for a name that there is not."""
    path = Path(name)
    if path.suffix == ".toml":
        return path
    if name not in bench_names():
        raise unknown("bench", name, bench_names())
    return data_path("hardware", "benches", f"{name}.toml")


def load_bench(name: str) -> BenchSettings:
    """A profile that ships, by name, or a TOML file by its path. Raises InputError."""
    path = bench_path(name)
    keys = read_toml(path, "bench profile")
    with located(f"bench {path}"):
        return BenchSettings(**keys)
