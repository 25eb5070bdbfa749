"""The seam between the loop and what has a handlebar: virtual, recorded, or on a bench."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.record.channels import Channel


class Sample(NamedTuple):
    """What the sensors said: time [s], steer angle [rad] and rate [rad/s]; right is positive.

    Of a batch: one time, and arrays.
    """

    time: float
    steer: Real
    steer_rate: Real


class RigFinished(Exception):
    """A rig that has no more to give: the end of a recording, say. Ends a run, is no error."""


@dataclass(frozen=True, slots=True)
class RigInfo:
    """What the loop and the record must know of a rig.

    `period` [s] between two ticks; `inertia` I_δ [kg m²] about the steer axis without the
    rider's arms; `steer_stop` [rad] each side; `channels`: what `telemetry` gives, in order.
    """

    name: str
    period: float
    inertia: float
    steer_stop: float
    channels: tuple[Channel, ...] = ()


class Rig(Protocol):
    """A handlebar with sensors and a motor, and somebody's hands on it.

    A tick is `read`, `command`, `show`, `telemetry`, `wait`, in this order.
    """

    @property
    def info(self) -> RigInfo: ...

    def read(self) -> Sample:
        """The newest sample. Raises RigFinished when there will be none."""
        ...

    def command(self, torque: Real) -> Real:
        """Ask the motor for a feedback torque [N m]; gives what was really sent."""
        ...

    def show(self, bicycle: BicycleState) -> None:
        """Show the rider the bicycle: a display, or a model's eyes."""
        ...

    def telemetry(self) -> tuple[Real, ...]:
        """What only this rig knows, one value for each of `info.channels`."""
        ...

    def wait(self) -> None:
        """Until the next tick: step the physics, or sleep to the deadline."""
        ...

    def close(self) -> None:
        """Zero torque and a disabled motor; may be called twice."""
        ...
