"""A rider who steers by the roll that he sees, late and through his muscles."""

from collections import deque
from collections.abc import Iterator

from bikesim.model.haptic import BicycleState
from bikesim.rider.base import Arms
from bikesim.rider.muscle import Neuromuscular


class RollPD:
    """T_δ = G_nm(s) (k_φ φ + k_φ̇ φ̇)(t - τ) + remnant, with passive arms.

    Positive gains steer into the fall. `roll_gain` [N m/rad], `roll_rate_gain` [N m s/rad],
    `delay_steps` is the visual delay τ in physics steps; `noise` gives the remnant [N m].
    """

    def __init__(
        self,
        *,
        roll_gain: float,
        roll_rate_gain: float,
        delay_steps: int,
        muscle: Neuromuscular,
        noise: Iterator[float],
        arms: Arms,
    ) -> None:
        self.arms = arms
        self._gains = roll_gain, roll_rate_gain
        self._muscle = muscle
        self._noise = noise
        self._delayed = deque([0.0] * delay_steps)

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        """One physics step; see the class."""
        roll_gain, roll_rate_gain = self._gains
        self._delayed.append(roll_gain * seen.roll + roll_rate_gain * seen.roll_rate)
        return self._muscle(self._delayed.popleft()) + next(self._noise)
