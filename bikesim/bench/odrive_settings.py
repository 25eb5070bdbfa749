"""What a bench profile says of its ODrive."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from bikesim.settings import Settings


class ODriveSettings(Settings):
    """An ODrive in torque mode, its motor and its gear.

    Torque and speed limits are at the steer axis; the torque constant at the motor's shaft. The
    watchdog and the periods of the cyclic messages are set in the ODrive itself (by USB); the
    set-up sees that they are as here. It knows no rated torque: limits.continuous_torque, the
    motor's at the steer axis, is held against nothing.
    """

    table: ClassVar[str] = "drive"

    kind: Literal["odrive"] = Field(default="odrive", description="Of drive.")
    node: Annotated[int, Field(ge=0, le=62)] = Field(
        description="Node number on the bus; 8 and 9 are the sensor nodes' where there is one."
    )
    torque_constant: Annotated[float, Field(ge=1e-3, le=100)] = Field(
        description="Of the motor [N m/A], as the ODrive has it."
    )
    gear: Annotated[float, Field(ge=0.1, le=1000)] = Field(
        default=1.0, description="Turns of the motor for one of the handlebar."
    )
    direction: Literal[1, -1] = Field(
        default=1, description="1: positive torque turns the handlebar to the right; -1: left."
    )
    torque_limit: Annotated[float, Field(gt=0, le=10)] = Field(
        description="At the steer axis [N m]; the ODrive keeps to it too, by its current limit."
    )
    speed_limit: Annotated[float, Field(gt=0, le=100)] = Field(
        default=8.0, description="At the steer axis [rad/s]; the ODrive keeps to it too."
    )
    watchdog_timeout: Annotated[float, Field(ge=0.005, le=0.2)] = Field(
        default=0.03, description="No torque command for so long [s]: the ODrive disarms itself."
    )
    heartbeat_period: Annotated[float, Field(ge=0.001, le=0.5)] = Field(
        default=0.1, description="Time between two heartbeats of the ODrive [s]."
    )
    estimates_period: Annotated[float, Field(ge=0.001, le=0.1)] = Field(
        default=0.001, description="Time between two encoder estimates of the ODrive [s]."
    )
    torques_period: Annotated[float, Field(ge=0.001, le=0.1)] = Field(
        default=0.002, description="Time between two torque estimates of the ODrive [s]."
    )

    @property
    def watchdog(self) -> float:
        """The host silent for so long [s]: the drive disables itself."""
        return self.watchdog_timeout

    @property
    def motor_torque_limit(self) -> float:
        """At the motor's shaft [N m]."""
        return self.torque_limit / self.gear

    @property
    def current_limit(self) -> float:
        """Of the motor [A]."""
        return self.motor_torque_limit / self.torque_constant

    @property
    def velocity_limit(self) -> float:
        """Of the motor [turns/s]."""
        return self.speed_limit * self.gear / (2 * math.pi)

    def to_motor(self, torque: float) -> float:
        """Torque at the shaft [N m] for one at the steer axis, within the limit.

        Zero for what is not finite.
        """
        if not math.isfinite(torque):
            return 0.0
        limited = max(-self.torque_limit, min(self.torque_limit, torque))
        return limited * self.direction / self.gear

    def torque(self, motor_torque: float) -> float:
        """At the steer axis [N m], right positive."""
        return motor_torque * self.gear * self.direction

    def steer(self, position: float) -> float:
        """At the steer axis [rad], of a position [turns], from where the encoder has its zero."""
        return 2 * math.pi * position / self.gear * self.direction

    def steer_rate(self, velocity: float) -> float:
        """At the steer axis [rad/s], of a velocity [turns/s]."""
        return 2 * math.pi * velocity / self.gear * self.direction
