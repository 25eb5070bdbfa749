"""A motor and its encoder as an emulated CiA 402 drive has them, at the shaft."""

import math
from dataclasses import dataclass

from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.rated_torque import UNITS

_RPM = 2 * math.pi / 60  # rad/s
_INT32 = 2**32


@dataclass(frozen=True, slots=True)
class Motor:
    """Rated torque [N m] and the unit in which object 6076 has it; counts a turn; velocity unit."""

    rated_torque: float
    torque_unit: str
    encoder_counts: int
    velocity_unit: str

    @classmethod
    def of_profile(cls, drive: Cia402Settings) -> "Motor":
        """The one that a profile expects."""
        return cls(drive.rated_torque, drive.torque_unit, drive.encoder_counts, drive.velocity_unit)

    @property
    def rated_torque_object(self) -> int:
        """Object 6076."""
        return round(self.rated_torque / UNITS[self.torque_unit])

    def torque(self, per_mille: int) -> float:
        """At the shaft [N m]."""
        return per_mille * self.rated_torque / 1000

    def position(self, angle: float) -> int:
        """Object 6064 for an angle of the shaft [rad]; wraps around as 32 bits do."""
        counts = math.floor(angle * self.encoder_counts / (2 * math.pi) + 0.5)
        return (counts + _INT32 // 2) % _INT32 - _INT32 // 2

    def velocity(self, rate: float) -> int:
        """Object 606C for a rate of the shaft [rad/s]."""
        units = {"rpm": _RPM, "mrpm": _RPM / 1000, "counts/s": 2 * math.pi / self.encoder_counts}
        return round(rate / units[self.velocity_unit])

    @staticmethod
    def rpm(rate: float) -> float:
        """As object 6080 has it."""
        return rate / _RPM
