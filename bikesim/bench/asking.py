"""How whoever holds the bar asks for another attempt: with the bar, as his hands are on it."""

import math

ASK = "turn the bar to a side, then hold it straight"
"""What a person reads on the display; an emulated rider reads it too."""

TURNED = math.radians(10.0)
"""A bar that nobody holds does not turn so far by itself [rad]."""

STRAIGHT, STILL = math.radians(5.0), 0.2
"""At most, to be held straight [rad], [rad/s]."""

HELD = 1.0
"""So long it is to be held [s]."""

# Of an emulated person: stiffness [N m/rad] and damping [N m s/rad] of his hands, how far he turns
# the bar [rad] and for how long [s].
_STIFFNESS, _DAMPING, _FAR, _AWAY = 20.0, 2.8, 0.3, 0.8


class Asking:
    """Sees whether the bar was turned to a side and is held straight since."""

    def __init__(self) -> None:
        self._turned = False
        self._since: float | None = None

    def __call__(self, time: float, steer: float, steer_rate: float) -> bool:
        """At a time [s], for the measured angle [rad] and rate [rad/s]."""
        self._turned |= abs(steer) >= TURNED
        if not (self._turned and abs(steer) <= STRAIGHT and abs(steer_rate) <= STILL):
            self._since = None
            return False
        self._since = time if self._since is None else self._since
        return time - self._since >= HELD


def asking_torque(since: float, steer: float, steer_rate: float) -> float:
    """Of the hands of an emulated person [N m] who asks `since` so many seconds."""
    wanted = _FAR if since < _AWAY else 0.0
    return _STIFFNESS * (wanted - steer) - _DAMPING * steer_rate
