"""Nobody at the bar."""

from bikesim.model.haptic import BicycleState
from bikesim.rider.base import Arms


class HandsOff:
    """No torque, no arms: the bicycle by itself."""

    arms = Arms()

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        """Zero."""
        return 0.0
