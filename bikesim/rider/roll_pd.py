"""A rider who steers by the roll that he sees."""

from bikesim.model.real import Real
from bikesim.rider.base import Setting, Sight


class RollPD:
    """T = k_φ φ + k_φ̇ φ̇. Positive gains steer into the fall.

    `roll_gain` k_φ [N m/rad], `roll_rate_gain` k_φ̇ [N m s/rad].
    """

    def __init__(
        self, setting: Setting, *, roll_gain: Real = 3.0, roll_rate_gain: Real = 5.0
    ) -> None:
        del setting
        self._gains = roll_gain, roll_rate_gain

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """The intended torque [N m]; see the class."""
        roll_gain, roll_rate_gain = self._gains
        return roll_gain * seen.roll + roll_rate_gain * seen.roll_rate
