"""An emulated speed sensor at the wheel, as a pure state machine."""

import math

from bikesim.bench.database import WHEEL_SPEED, cycle_time, message
from bikesim.bench.emulated.device import Periodic
from bikesim.bench.frame import Frame
from bikesim.bench.wheel_node import WheelEncoder, WheelSettings

_PULSES = 32  # a turn


class EmulatedWheelNode:
    """`speed` [m/s] is set from outside."""

    def __init__(self, settings: WheelSettings) -> None:
        self.speed = 0.0
        self.sensor_ok = True
        self._radius = settings.radius
        self._turns = 0.0
        self._last: float | None = None
        self._encoder = WheelEncoder(settings)
        self._due = Periodic(cycle_time(message(WHEEL_SPEED)))

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        """See `Device`."""
        del frame, time
        return []

    def advance(self, time: float) -> list[Frame]:
        """See `Device`."""
        passed = 0.0 if self._last is None else time - self._last
        self._last = time
        self._turns += abs(self.speed) / self._radius / math.tau * passed
        if not self._due.due(time):
            return []
        pulses = int(self._turns * _PULSES)
        return [self._encoder.encode(time, self.speed, pulses, self.sensor_ok)]
