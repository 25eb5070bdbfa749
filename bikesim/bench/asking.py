"""How whoever holds the bar asks for another attempt: with the bar, as his hands are on it."""

import math

ASK = "hold the bar straight, turn it to a side, and hold it straight again"
"""What a person reads on the display; an emulated rider reads it too."""

TURNED = math.radians(10.0)
"""At least, to a side [rad]."""

STRAIGHT = math.radians(5.0)
"""At most, to be held straight [rad]."""

STILL = math.radians(2.0)
"""A bar that is held moves by no more [rad]; by its angle, as an encoder's rate is coarse."""

HELD, AWAY = 1.0, 0.2
"""So long it is to be held straight each time, and turned to a side [s]."""

_GAP = 0.05  # s between two looks; who was not seen for longer was not seen to hold anything

# Of an emulated person: stiffness [N m/rad] and damping [N m s/rad] of his hands, how far he turns
# the bar [rad], from when until when [s].
_STIFFNESS, _DAMPING, _FAR, _FROM, _UNTIL = 20.0, 2.8, 0.3, 2.5, 3.3


class Asking:
    """Sees that the bar is held straight, then turned to a side, then held straight again.

    In this order: where the bar was left when the bicycle fell says nothing, nor that it is
    brought back, or comes back by itself.
    """

    def __init__(self) -> None:
        self._last = -math.inf
        self._done = 0
        """Of the three."""
        self._since: float | None = None
        self._lowest = self._highest = 0.0

    def __call__(self, time: float, steer: float, *, good: bool = True) -> bool:
        """At a time [s], for the measured angle [rad]; `good`: whether it is to be believed."""
        if not good or time - self._last > _GAP:
            self._done, self._since = 0, None
        self._last = time
        if not good:
            return False
        if self._done == 1:
            self._turned(time, steer)
        elif self._held(time, steer):
            self._done, self._since = self._done + 1, None
        return self._done == 3

    def _turned(self, time: float, steer: float) -> None:
        if abs(steer) < TURNED:
            self._since = None
            return
        self._since = time if self._since is None else self._since
        if time - self._since >= AWAY:
            self._done, self._since = 2, None

    def _held(self, time: float, steer: float) -> bool:
        if abs(steer) > STRAIGHT:
            self._since = None
            return False
        if self._since is None:
            self._since, self._lowest, self._highest = time, steer, steer
        self._lowest, self._highest = min(self._lowest, steer), max(self._highest, steer)
        if self._highest - self._lowest > STILL:
            self._since, self._lowest, self._highest = time, steer, steer
        return time - self._since >= HELD


def asking_torque(since: float, steer: float, steer_rate: float) -> float:
    """Of the hands of an emulated person [N m] who asks `since` so many seconds."""
    wanted = _FAR if _FROM <= since < _UNTIL else 0.0
    return _STIFFNESS * (wanted - steer) - _DAMPING * steer_rate
