"""What a bench profile says of its CiA 402 drive."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from bikesim.bench.drive_scale import DriveScale
from bikesim.settings import Settings

_Node = Annotated[int, Field(ge=1, le=127)]
_Unsigned32 = Annotated[int, Field(ge=0, le=0xFFFFFFFF)]

# Of rated torque: no drive gives more for a moment; a profile that asks for more has a wrong unit.
_LARGEST_OVERLOAD = 10.0


class DriveObject(Settings):
    """An object that is written to the drive besides those that any bench needs."""

    table: ClassVar[str] = "drive.objects"

    index: Annotated[int, Field(ge=0x1000, le=0xFFFF)] = Field(description="Of the object.")
    subindex: Annotated[int, Field(ge=0, le=255)] = Field(default=0, description="Of the object.")
    value: int = Field(description="What it is set to.")


class Cia402Settings(Settings):
    """A drive in cyclic synchronous torque mode, its motor and its gear.

    Torque and speed limits are at the steer axis; rated torque and encoder at the motor's shaft.
    """

    table: ClassVar[str] = "drive"

    kind: Literal["cia402"] = Field(default="cia402", description="Of drive.")
    node: _Node = Field(description="Node number on the bus.")
    eds: str = Field(
        default="cia402_drive.eds",
        description="EDS: one that ships, or the path of a file, from the current folder.",
    )
    vendor_id: _Unsigned32 | None = Field(
        default=None, description="Object 1018:01 as it must be; default: not checked."
    )
    product_code: _Unsigned32 | None = Field(
        default=None, description="Object 1018:02 as it must be; default: not checked."
    )
    rated_torque: Annotated[float, Field(ge=1e-3, le=1000)] = Field(
        description="Of the motor's nameplate [N m]; what object 6076 must say."
    )
    torque_unit: Literal["uNm", "mNm"] = Field(
        description="Of object 6076: it differs between makers."
    )
    gear: Annotated[float, Field(ge=0.1, le=1000)] = Field(
        default=1.0, description="Turns of the motor for one of the handlebar."
    )
    direction: Literal[1, -1] = Field(
        default=1, description="1: positive torque turns the handlebar to the right; -1: left."
    )
    encoder_counts: Annotated[int, Field(ge=1, le=2**30)] = Field(
        description="Counts for one turn of the motor; what object 608F must say, if it is there."
    )
    velocity_unit: Literal["rpm", "mrpm", "counts/s"] = Field(
        default="rpm", description="Of object 606C."
    )
    torque_limit: Annotated[float, Field(gt=0, le=10)] = Field(
        description="At the steer axis [N m]; the drive keeps to it too (6072)."
    )
    speed_limit: Annotated[float, Field(gt=0, le=100)] = Field(
        default=8.0, description="At the steer axis [rad/s]; the drive keeps to it too (6080)."
    )
    host_node: _Node = Field(default=127, description="Node number of the host's heartbeat.")
    heartbeat_timeout: Annotated[float, Field(ge=0.005, le=0.2)] = Field(
        default=0.03, description="The host silent for so long [s]: the drive disables itself."
    )
    heartbeat_period: Annotated[float, Field(ge=0.002, le=0.5)] = Field(
        default=0.01, description="Time between two heartbeats of the drive [s]."
    )
    objects: Annotated[tuple[DriveObject, ...], Strict(False)] = Field(
        default=(),
        description="More objects that this drive needs, none of the set-up's own; read back.",
    )

    @property
    def watchdog(self) -> float:
        """The host silent for so long [s]: the drive disables itself."""
        return self.heartbeat_timeout

    @property
    def scale(self) -> DriveScale:
        """Between the steer axis and the drive's own units."""
        return DriveScale.of_motor(
            rated_torque=self.rated_torque,
            gear=self.gear,
            direction=self.direction,
            encoder_counts=self.encoder_counts,
            velocity_unit=self.velocity_unit,
            torque_limit=self.torque_limit,
        )

    @model_validator(mode="after")
    def _is_possible(self) -> "Cia402Settings":
        if self.host_node == self.node:
            raise ValueError(f"host_node = {self.host_node}: is the drive's own node")
        if self.torque_limit > _LARGEST_OVERLOAD * self.rated_torque * self.gear:
            raise ValueError(
                f"torque_limit = {self.torque_limit}: is more than {_LARGEST_OVERLOAD:g} times "
                f"rated torque × gear = {self.rated_torque * self.gear:g} N m"
            )
        if self.scale.torque_limit < 1:
            raise ValueError(
                f"torque_limit = {self.torque_limit}: is less than a thousandth of "
                f"rated torque × gear = {self.rated_torque * self.gear:g} N m"
            )
        from bikesim.bench.cia402_objects import doubly_written

        if wrong := doubly_written(self):
            raise ValueError(wrong)
        return self
