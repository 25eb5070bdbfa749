"""Watchers of the sensor node's frames and of angle against gyro: rows 1 to 7."""

import math
from collections.abc import Callable

from bikesim.bench.faults import Fault, Observation, Reaction

_ROOT2 = math.sqrt(2)


def sensor_flags(o: Observation) -> Fault | None:
    """Row 4; what the node says of the gyro and the reference counts likewise."""
    if o.pot_ok and o.gyro_ok and o.vref_ok:
        return None
    named = (
        ("potentiometer open or short", o.pot_ok),
        ("gyro out of range", o.gyro_ok),
        ("reference voltage wrong", o.vref_ok),
    )
    what = ", ".join(name for name, ok in named if not ok)
    return Fault(4, what, "sound sensors", Reaction.ZERO)


class Lasting:
    """Says for how long [s] something has been so."""

    def __init__(self) -> None:
        self._since: float | None = None

    def __call__(self, is_so: bool, time: float) -> float:
        if not is_so:
            self._since = None
            return 0.0
        self._since = time if self._since is None else self._since
        return time - self._since


class FrameLost:
    """Row 1: by the age of the newest good sample."""

    def __init__(self, hold: float, ramp: float, zero: float) -> None:
        self._hold, self._ramp, self._zero = hold, ramp, zero

    def __call__(self, o: Observation) -> Fault | None:
        if o.age <= self._hold:
            return None
        if o.age > self._zero:
            return self._fault(o.age, self._zero, Reaction.ZERO)
        if o.age > self._ramp:
            return self._fault(o.age, self._ramp, Reaction.RAMP)
        return self._fault(o.age, self._hold, Reaction.HOLD)

    def _fault(self, age: float, limit: float, reaction: Reaction) -> Fault:
        what = f"no good sensor frame for {1e3 * age:.1f} ms"
        return Fault(1, what, f"{1e3 * limit:g} ms", reaction)


class InARow:
    """Rows 2 and 3: sensor frames that cannot be used."""

    def __init__(self, row: int, what: str, count: Callable[[Observation], int], most: int) -> None:
        self._row, self._what, self._count, self._most = row, what, count, most

    def __call__(self, o: Observation) -> Fault | None:
        count = self._count(o)
        if count < self._most:
            return None
        what = f"{count} sensor frames {self._what} in a row"
        return Fault(self._row, what, f"less than {self._most}", Reaction.ZERO)


class AngleStep:
    """Row 7: the angle between two ticks; after lost frames or ticks, as much for each of them."""

    def __init__(self, step: float, period: float) -> None:
        self._step, self._period = step, period
        self._last = math.nan
        self._time = 0.0

    def __call__(self, o: Observation) -> Fault | None:
        if not o.fresh:
            return None
        jump = abs(o.steer - self._last)
        allowed = self._step * max(1.0, (o.sample_time - self._time) / self._period)
        self._last, self._time = o.steer, o.sample_time
        if not jump > allowed:
            return None
        what = f"steer angle jumped by {1e3 * jump:.1f} mrad"
        return Fault(7, what, f"{1e3 * allowed:.1f} mrad", Reaction.ZERO)


class Slip:
    """Row 5: the angle's own rate against the gyro's, both through the same low pass.

    A second-order Butterworth of the angle with a corner that passes a hand (12 Hz); its
    derivative is a state of it, so that nothing is differenced. The gyro goes through it alike.
    """

    _CORNER = 75.0  # rad/s

    def __init__(self, rate: float, time: float) -> None:
        self._limit, self._time = rate, time
        self._last: float | None = None
        self._angle = self._angle_rate = self._gyro = self._gyro_rate = 0.0
        self._lasting = Lasting()

    def __call__(self, o: Observation) -> Fault | None:
        if not o.fresh:
            return None
        if self._last is None:
            self._angle, self._gyro = o.steer, o.steer_rate
            self._angle_rate = o.steer_rate
        else:
            self._filter(o.steer, o.steer_rate, o.sample_time - self._last)
        self._last = o.sample_time
        apart = abs(self._angle_rate - self._gyro)
        slips = not apart <= self._limit
        lasting = self._lasting(slips, o.time)
        if not slips or lasting < self._time - 1e-6:
            return None
        what = f"angle sensor {apart:.2f} rad/s from the gyro for {1e3 * self._time:g} ms"
        return Fault(5, what, f"{self._limit:g} rad/s", Reaction.ZERO)

    def _filter(self, angle: float, rate: float, h: float) -> None:
        """Semi-implicit, stable for any sample of a few milliseconds."""
        w = self._CORNER
        h = min(max(h, 0.0), 0.01)
        divide = 1 + h * _ROOT2 * w + h * h * w * w
        self._angle_rate = (self._angle_rate + h * w * w * (angle - self._angle)) / divide
        self._angle += h * self._angle_rate
        self._gyro_rate = (self._gyro_rate + h * w * w * (rate - self._gyro)) / divide
        self._gyro += h * self._gyro_rate


class Bias:
    """Row 6: what the gyro says the bar has turned, forgotten over some seconds, against the angle.

    Angle through τs/(τs+1) and gyro through τ/(τs+1) are the same thing twice; a bias of the gyro
    parts them by bias × τ. After a long gap, over which nothing can be integrated, it begins anew.
    """

    _LONGEST = 0.02  # s

    def __init__(self, angle: float, time: float) -> None:
        self._limit, self._time = angle, time
        self._last: float | None = None
        self._slow = self._leaky = self._rate = 0.0

    def __call__(self, o: Observation) -> Fault | None:
        if not o.fresh:
            return None
        last, self._last = self._last, o.sample_time
        rate, self._rate = 0.5 * (self._rate + o.steer_rate), o.steer_rate
        if last is None or o.sample_time - last > self._LONGEST:
            self._slow, self._leaky = o.steer, 0.0
            return None
        h = o.sample_time - last
        share = h / (self._time + h)
        self._slow += share * (o.steer - self._slow)
        self._leaky += share * (self._time * rate - self._leaky)
        apart = abs(o.steer - self._slow - self._leaky)
        if apart <= self._limit:
            return None
        what = f"gyro's angle {apart:.3f} rad from the angle sensor's (bias)"
        return Fault(6, what, f"{self._limit:g} rad", Reaction.RAMP)
