"""One small watcher for each fault: looks at every tick's observation, says what it sees.

They keep nothing but what the fault is about, and are asked at every tick, fault or not.
"""

import math
from collections import deque
from collections.abc import Callable

from bikesim.bench.faults import Fault, Observation, Reaction, Thresholds
from bikesim.bench.sensor_monitors import (
    AngleStep,
    Bias,
    FrameLost,
    InARow,
    Lasting,
    Slip,
    sensor_flags,
)

Monitor = Callable[[Observation], Fault | None]


def monitors(
    thresholds: Thresholds, heartbeat_period: float, period: float = 0.001
) -> tuple[Monitor, ...]:
    """All that look at what came over the bus; `heartbeat_period` [s] is the drive's, `period` [s]
    that of the loop.
    """
    t = thresholds
    return (
        AtOnce(t, heartbeat_period),
        AngleStep(t.angle_step, period),
        Slip(t.slip_rate, t.slip_time),
        Bias(t.bias_angle, t.bias_time),
        _OverSpeed(t.trip_rate, t.trip_rate_time),
        _NotFollowed(t.follow_error, t.follow_time),
        _Overrun(t.late, t.late_ticks, t.late_most),
        _Skipping(t.skipped_share, period),
    )


class AtOnce:
    """Those that remember nothing: the gravest of what one observation shows.

    They are asked one by one only where anything is out of bounds, which is seldom; a tick has
    better things to do.
    """

    def __init__(self, t: Thresholds, heartbeat_period: float) -> None:
        self._drive_age, self._hold_age = t.drive_age, t.hold_age
        self._heartbeat_age = t.drive_heartbeats * heartbeat_period
        self._bad_frames, self._frozen_frames = t.bad_frames, t.frozen_frames
        self._angle = math.radians(t.trip_angle_deg)
        self.each: tuple[Monitor, ...] = (
            emergency_stop,
            bus_trouble,
            second_master,
            drive_error,
            drive_trouble,
            _DriveSilent(t.drive_age, self._heartbeat_age),
            FrameLost(t.hold_age, t.ramp_age, t.zero_age),
            InARow(2, "with a wrong checksum", lambda o: o.bad_frames, t.bad_frames),
            InARow(3, "repeated or frozen", lambda o: o.frozen_frames, t.frozen_frames),
            sensor_flags,
            _OverAngle(self._angle),
        )

    def __call__(self, o: Observation) -> Fault | None:
        if (
            o.estop_closed
            and o.pot_ok
            and o.gyro_ok
            and o.vref_ok
            and not (o.bus_trouble or o.second_master or o.drive_error or o.drive_trouble)
            and o.drive_age <= self._drive_age
            and o.drive_heartbeat_age <= self._heartbeat_age
            and o.age <= self._hold_age
            and o.bad_frames < self._bad_frames
            and o.frozen_frames < self._frozen_frames
            and -self._angle <= o.steer <= self._angle
        ):
            return None
        gravest: Fault | None = None
        for look in self.each:
            fault = look(o)
            if fault is not None and (gravest is None or fault.reaction > gravest.reaction):
                gravest = fault
        return gravest


def emergency_stop(o: Observation) -> Fault | None:
    """Row 21. The hardware cuts the power by itself; this only ends the run."""
    if o.estop_closed:
        return None
    return Fault(21, "emergency stop", "a closed circuit", Reaction.ZERO)


def bus_trouble(o: Observation) -> Fault | None:
    """Row 20."""
    return Fault(20, o.bus_trouble, "a sound bus", Reaction.ZERO) if o.bus_trouble else None


def second_master(o: Observation) -> Fault | None:
    """Row 24, while riding; before, it is a reason not to enable."""
    if not o.second_master:
        return None
    return Fault(24, "another host commands the drive", "one host", Reaction.ZERO)


def drive_error(o: Observation) -> Fault | None:
    """Row 17."""
    return (
        Fault(17, o.drive_error, "no error of the drive", Reaction.ZERO) if o.drive_error else None
    )


def drive_trouble(o: Observation) -> Fault | None:
    """Row 15."""
    if not o.drive_trouble:
        return None
    return Fault(15, o.drive_trouble, "enabled, in torque mode", Reaction.ZERO)


class _OverAngle:
    """Row 8."""

    def __init__(self, angle: float) -> None:
        self._limit = angle

    def __call__(self, o: Observation) -> Fault | None:
        if abs(o.steer) <= self._limit:
            return None
        what = f"steer angle {math.degrees(o.steer):.1f} deg"
        return Fault(8, what, f"{math.degrees(self._limit):g} deg", Reaction.ZERO)


class _OverSpeed:
    """Row 9."""

    def __init__(self, rate: float, time: float) -> None:
        self._limit, self._time = rate, time
        self._lasting = Lasting()

    def __call__(self, o: Observation) -> Fault | None:
        fast = not abs(o.steer_rate) <= self._limit
        lasting = self._lasting(fast, o.time)
        if not fast or lasting < self._time - 1e-6:
            return None
        what = f"steer rate {o.steer_rate:.1f} rad/s for {1e3 * self._time:g} ms"
        return Fault(9, what, f"{self._limit:g} rad/s", Reaction.ZERO)


class _DriveSilent:
    """Row 14: by the age of its process data, and of its heartbeat."""

    def __init__(self, data: float, heartbeat: float) -> None:
        self._data, self._heartbeat = data, heartbeat

    def __call__(self, o: Observation) -> Fault | None:
        if o.drive_age > self._data:
            return self._fault("data", o.drive_age, self._data)
        if o.drive_heartbeat_age > self._heartbeat:
            return self._fault("heartbeat", o.drive_heartbeat_age, self._heartbeat)
        return None

    def _fault(self, what: str, age: float, most: float) -> Fault:
        said = f"no {what} of the drive for {1e3 * age:.1f} ms"
        return Fault(14, said, f"{1e3 * most:g} ms", Reaction.ZERO)


class _NotFollowed:
    """Row 16: torque that the drive measures against that which it was told."""

    def __init__(self, error: float, time: float) -> None:
        self._limit, self._time = error, time
        self._lasting = Lasting()

    def __call__(self, o: Observation) -> Fault | None:
        error = o.torque_measured - o.torque_sent
        apart = not abs(error) <= self._limit
        lasting = self._lasting(apart, o.time)
        if not apart or lasting < self._time - 1e-6:
            return None
        what = f"torque {error:+.2f} N m from the commanded for {1e3 * self._time:g} ms"
        return Fault(16, what, f"{self._limit:g} N m", Reaction.ZERO)


class _Overrun:
    """Row 19: ticks that are late."""

    def __init__(self, late: float, ticks: int, most: float) -> None:
        self._late, self._ticks, self._most = late, ticks, most
        self._in_a_row = 0

    def __call__(self, o: Observation) -> Fault | None:
        self._in_a_row = self._in_a_row + 1 if o.late > self._late else 0
        if o.late > self._most:
            what = f"a tick {1e3 * o.late:.1f} ms late"
            return Fault(19, what, f"{1e3 * self._most:g} ms", Reaction.RAMP)
        if self._in_a_row >= self._ticks:
            what = f"{self._in_a_row} ticks in a row more than {1e3 * self._late:g} ms late"
            return Fault(19, what, f"less than {self._ticks}", Reaction.RAMP)
        return None


class _Skipping:
    """Row 19: a loop that is always too slow. A tick that leaves some out is on time again."""

    _OVER = 1.0  # s

    def __init__(self, share: float, period: float) -> None:
        self._share, self._all = share, self._OVER / period
        self._seen: deque[tuple[float, int]] = deque()
        self._sum = 0

    def __call__(self, o: Observation) -> Fault | None:
        if o.skipped:
            self._seen.append((o.time, o.skipped))
            self._sum += o.skipped
        while self._seen and self._seen[0][0] <= o.time - self._OVER:
            self._sum -= self._seen.popleft()[1]
        if self._sum <= self._share * self._all:
            return None
        what = f"{100 * self._sum / self._all:.0f} % of the ticks of a second left out"
        return Fault(19, what, f"{100 * self._share:g} %", Reaction.RAMP)
