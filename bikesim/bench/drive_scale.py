"""Between the steer axis in SI and a CiA 402 drive's own units at the motor's shaft."""

import math
from dataclasses import dataclass
from typing import Self

_RPM = 2 * math.pi / 60  # rad/s


@dataclass(frozen=True, slots=True)
class DriveScale:
    """Steer axis in SI, right positive; drive in per mille of rated torque, counts, its velocity.

    torque at the steer axis = direction × gear × torque of the motor; its angle is that of the
    motor / gear. `torque_limit` [per mille], always positive; no efficiency of the gear is known.
    """

    torque_per_unit: float  # N m at the steer axis for a per mille, signed
    angle_per_count: float  # rad at the steer axis, signed
    rate_per_unit: float  # rad/s at the steer axis for a unit of velocity, signed
    torque_limit: int

    @classmethod
    def of_motor(
        cls,
        *,
        rated_torque: float,
        gear: float,
        direction: int,
        encoder_counts: int,
        velocity_unit: str,
        torque_limit: float,
    ) -> Self:
        """Rated torque [N m] at the shaft, counts for a turn of it, limit [N m] at the axis."""
        count = 2 * math.pi / encoder_counts
        velocity = {"rpm": _RPM, "mrpm": _RPM / 1000, "counts/s": count}[velocity_unit]
        unit = rated_torque * gear / 1000
        return cls(
            torque_per_unit=direction * unit,
            angle_per_count=direction * count / gear,
            rate_per_unit=direction * velocity / gear,
            # Down: a limit is not to be exceeded by rounding. Not by that of the division either.
            torque_limit=math.floor(torque_limit / unit * (1 + 1e-12)),
        )

    def to_drive(self, torque: float) -> int:
        """The target torque (6071) for a torque at the steer axis [N m], within the limit.

        Zero for what is not finite.
        """
        if not math.isfinite(torque):
            return 0
        units = round(torque / self.torque_per_unit)
        return max(-self.torque_limit, min(self.torque_limit, units))

    def torque(self, units: int) -> float:
        """At the steer axis [N m], of a torque (6071, 6077) in per mille."""
        return units * self.torque_per_unit

    def steer(self, position: int) -> float:
        """At the steer axis [rad], of a position (6064), from where the encoder has its zero."""
        return position * self.angle_per_count

    def steer_rate(self, velocity: int) -> float:
        """At the steer axis [rad/s], of a velocity (606C)."""
        return velocity * self.rate_per_unit
