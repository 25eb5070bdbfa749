"""The bicycle's speed as the rider pedals it: from the sensor at the wheel, into the loop."""

import math

from bikesim.bench.continuity import BadFrame
from bikesim.bench.faults import Fault, Observation, Reaction
from bikesim.bench.frame import Frame
from bikesim.bench.wheel_node import WheelDecoder, WheelSettings
from bikesim.loop import Course, Moments

_CHANGE = 4.0  # m/s², of the speed in the equations: above what legs and brakes do
_ROW = 26


class Wheel:
    """Takes the speed sensor's frames; see `Traffic`."""

    def __init__(self, settings: WheelSettings) -> None:
        self._decoder = WheelDecoder(settings)
        self.speed = 0.0
        """The newest good one [m/s]."""
        self.arrival = -math.inf
        """When it came [s]."""

    @property
    def ids(self) -> frozenset[int]:
        return frozenset((self._decoder.id,))

    def receive(self, frame: Frame, time: float) -> None:
        reading = self._decoder.decode(frame.data, time)
        if not isinstance(reading, BadFrame) and reading.sensor_ok:
            self.speed, self.arrival = reading.speed, time


class WheelCourse:
    """A course whose speed is the wheel's; what else happens is another's.

    The speed changes by at most 4 m/s² and is never above `fastest` [m/s] nor backwards; it begins
    as the wheel's.
    """

    def __init__(self, wheel: Wheel, other: Course, fastest: float) -> None:
        self._wheel, self._fastest = wheel, fastest
        self._other = other
        self._time: float | None = None
        self._speed = 0.0

    def speed(self, time: float) -> float:
        """[m/s] at a time [s]."""
        wanted = min(max(self._wheel.speed, 0.0), self._fastest)
        if self._time is None:
            self._speed = wanted
        else:
            most = _CHANGE * (time - self._time)
            self._speed += min(max(wanted - self._speed, -most), most)
        self._time = time
        return self._speed

    def disturbance(self, time: float) -> Moments:
        """As the other course has it."""
        return self._other.disturbance(time)


class WheelSilent:
    """A monitor: no good speed for longer than `allowed` [s]."""

    def __init__(self, wheel: Wheel, allowed: float) -> None:
        self._wheel, self._allowed = wheel, allowed
        self._arrival = -math.inf
        self._since: float | None = None

    def __call__(self, o: Observation) -> Fault | None:
        """Arrivals are on another clock than `o.time`; that one changed is what counts."""
        if self._wheel.arrival != self._arrival or self._since is None:
            self._arrival, self._since = self._wheel.arrival, o.time
        silent = o.time - self._since
        if silent <= self._allowed:
            return None
        return Fault(
            _ROW, f"no good speed frame for {silent:.2f} s", f"{self._allowed:g} s", Reaction.RAMP
        )
