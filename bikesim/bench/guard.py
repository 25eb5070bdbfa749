"""The guard of a bench: limits on the torque, ramps in and out, and what a fault leads to."""

import math
from collections.abc import Callable, Iterable
from typing import Annotated, ClassVar

from pydantic import Field

from bikesim.bench.faults import Fault, Observation, Reaction, Thresholds
from bikesim.bench.monitors import Monitor, monitors
from bikesim.guard import CLAMPED, REFUSED, SLEWED, Stop, Verdict
from bikesim.settings import Settings

HELD, RAMPED, COOLED, SOFT_STOP = 8, 16, 32, 64

CEILING = 10.0
"""No profile lets more out [N m]; arms are at the other end."""


class TorqueLimits(Settings):
    """What the motor may do to a person, and for how long to itself; at the steer axis."""

    table: ClassVar[str] = "limits"

    torque: Annotated[float, Field(gt=0, le=CEILING)] = Field(
        default=3.5, description="Largest feedback torque [N m]."
    )
    torque_rate: Annotated[float, Field(gt=0, le=1e5)] = Field(
        default=300.0, description="Its fastest change [N m/s]."
    )
    continuous_torque: Annotated[float, Field(gt=0, le=CEILING)] = Field(
        default=2.0,
        description="That the motor stands for ever, RMS [N m]; of CiA 402 at most rated_torque × "
        "gear; of an ODrive, which knows no rating, held against nothing.",
    )
    speed: Annotated[float, Field(gt=0, le=30)] = Field(
        default=10.0, description="Fastest that the bicycle goes, whatever the wheel says [m/s]."
    )


class BenchGuard:
    """Checks each tick's torque, and looks at what the bench observed; see `Checks` of the loop.

    Wanted → finite (row 10) → soft stop (8) → clamped (11) → scaled down when warm (13) → ramped in
    (25) → slewed (12). A fault holds the last torque (R1), ramps it out and then stops (R2), or
    stops at once (R3); what was graver once is never taken back.
    """

    def __init__(
        self,
        limits: TorqueLimits,
        thresholds: Thresholds,
        *,
        period: float,
        heartbeat_period: float,
        observe: Callable[[], Observation],
        end: float = math.inf,
        more: Iterable[Monitor] = (),
        mean_square: float = 0.0,
    ) -> None:
        """`observe` gives this tick's; `heartbeat_period` [s] is the drive's.

        At `end` [s] the torque ramps out and the run is over; `more` look besides. `mean_square`
        [(N m)²]: of the torque of a ride before, of which the motor is still warm.
        """
        self._limits, self._thresholds, self._period = limits, thresholds, period
        self._observe = observe
        self._monitors = (*monitors(thresholds, heartbeat_period, period), *more)
        self._end = end
        self._fall = math.radians(thresholds.fall_roll_deg)
        self._soft = math.radians(thresholds.soft_stop_deg)
        self._trip = math.radians(thresholds.trip_angle_deg)
        self._step = limits.torque_rate * period
        self._last = 0.0
        self._began: float | None = None
        self._saturated: float | None = None
        self._cooled: float | None = None
        self._slewed = 0
        self.mean_square = mean_square
        """Of the torque lately [(N m)²], for row 13."""
        self._out: _RampOut | None = None
        self._asked = ""
        self._before = (0, Reaction.HOLD)
        self.fault: Fault | None = None
        """The gravest so far, of those that end a run."""
        self.row = 0
        """Of the fault that the last tick saw; 0: none."""
        self.seen: list[Fault] = []
        """Each when it began or became graver."""

    def check(self, steer: float, roll: float, torque: float) -> Verdict:
        """For the measured steer angle [rad], the roll [rad] and T_f of eq. 6 [N m]."""
        o = self._observe()
        self._began = o.time if self._began is None else self._began
        if o.time >= self._end:
            self.ask_to_stop("end of run")
        fault = self._gravest(o, roll, torque)
        self._note(fault)
        if fault is not None and fault.reaction is Reaction.ZERO:
            return self._stopped(REFUSED)
        ramp = self._asked or (fault is not None and fault.reaction is Reaction.RAMP)
        if self._out is None and ramp:
            self._out = _RampOut(o.time, self._last, self._thresholds.ramp_out)
        if self._out is not None:
            return self._ramping(o.time)
        if fault is not None:
            return Verdict(self._last, HELD, None)
        return self._limited(o.time, steer, torque)

    def ask_to_stop(self, why: str) -> None:
        """Ramps out from the next tick on, as for a fault, without there being one."""
        self._asked = self._asked or why

    def _note(self, fault: Fault | None) -> None:
        if fault is None:
            self._before = (0, Reaction.HOLD)
            self.row = 0
            return
        before, self._before = self._before, (fault.row, fault.reaction)
        self.row = fault.row
        if self._before != before:
            self.seen.append(fault)
        if fault.reaction is Reaction.HOLD:
            return
        # A bar that whoever falls lets go of is of the fall, not its cause.
        if self.fault is not None and self.fault.row == _FELL and fault.row in _OF_THE_BAR:
            return
        if self.fault is None or fault.reaction > self.fault.reaction:
            self.fault = fault

    def _gravest(self, o: Observation, roll: float, torque: float) -> Fault | None:
        gravest = self._of_model(roll, torque)
        for look in self._monitors:
            fault = look(o)
            if fault is not None and (gravest is None or fault.reaction > gravest.reaction):
                gravest = fault
        return gravest if gravest is not None else self._of_limits(o.time)

    def _of_model(self, roll: float, torque: float) -> Fault | None:
        if not math.isfinite(torque) or not math.isfinite(roll):
            what = f"the law gives {torque} N m at a roll of {roll} rad"
            return Fault(10, what, "finite figures", Reaction.ZERO)
        if abs(roll) > self._fall:
            side = "right" if roll > 0 else "left"
            what = f"fell to the {side}: roll beyond {math.degrees(self._fall):.0f} deg"
            return Fault(23, what, "a rider in the saddle", Reaction.RAMP)
        return None

    def _of_limits(self, time: float) -> Fault | None:
        t = self._thresholds
        if self._saturated is not None and time - self._saturated > t.saturated_time:
            what = f"at the torque limit for {time - self._saturated:.2f} s"
            return Fault(11, what, f"{t.saturated_time:g} s", Reaction.RAMP)
        if self._slewed > t.slewed_ticks:
            what = f"the torque's rate limited for {self._slewed} ticks in a row"
            return Fault(12, what, f"{t.slewed_ticks}", Reaction.RAMP)
        if self._cooled is not None and time - self._cooled > t.cooled_time:
            warm = math.sqrt(self.mean_square)
            what = f"{warm:.2f} N m RMS over {t.thermal_time:g} s, scaled down {t.cooled_time:g} s"
            return Fault(13, what, f"{self._limits.continuous_torque:g} N m", Reaction.RAMP)
        return None

    def _limited(self, time: float, steer: float, torque: float) -> Verdict:
        torque, limited = self._softly_stopped(steer, torque)
        torque, flag = self._clamped(time, torque)
        limited |= flag
        torque, flag = self._scaled_down(time, torque)
        limited |= flag
        assert self._began is not None
        share = (time - self._began) / self._thresholds.ramp_in
        if share < 1.0:
            torque, limited = share * torque, limited | RAMPED
        change = torque - self._last
        if abs(change) > self._step:
            torque, limited = self._last + math.copysign(self._step, change), limited | SLEWED
            self._slewed += 1
        else:
            self._slewed = 0
        return self._out_goes(torque, limited)

    def _softly_stopped(self, steer: float, torque: float) -> tuple[float, int]:
        """Nearer to where it trips, less and less of a torque that turns the bar there."""
        if torque * steer <= 0 or abs(steer) <= self._soft:
            return torque, 0
        left = max(0.0, (self._trip - abs(steer)) / (self._trip - self._soft))
        return left * torque, SOFT_STOP

    def _clamped(self, time: float, torque: float) -> tuple[float, int]:
        if abs(torque) <= self._limits.torque:
            self._saturated = None
            return torque, 0
        self._saturated = time if self._saturated is None else self._saturated
        return math.copysign(self._limits.torque, torque), CLAMPED

    def _scaled_down(self, time: float, torque: float) -> tuple[float, int]:
        """As the RMS goes from the continuous rating to a tenth above it, down to that rating."""
        rating = self._limits.continuous_torque
        warm = math.sqrt(self.mean_square) / rating
        left = (_HOT - warm) / (_HOT - 1.0)
        most = rating + max(left, 0.0) * (self._limits.torque - rating)
        if warm <= 1.0 or abs(torque) <= most:
            self._cooled = None if warm <= 1.0 else self._cooled
            return torque, 0
        self._cooled = time if self._cooled is None else self._cooled
        return math.copysign(most, torque), COOLED

    def _ramping(self, time: float) -> Verdict:
        assert self._out is not None
        torque = self._out.torque(time)
        if torque is None:
            return self._stopped(RAMPED)
        return self._out_goes(torque, RAMPED)

    def _out_goes(self, torque: float, limited: int) -> Verdict:
        self._last = torque
        share = self._period / self._thresholds.thermal_time
        self.mean_square += share * (torque * torque - self.mean_square)
        return Verdict(torque, limited, None)

    def _stopped(self, limited: int) -> Verdict:
        self._last = 0.0
        if self.fault is None:
            return Verdict(0.0, limited, Stop(self._asked, fell=False))
        if self.fault.row == _FELL:
            return Verdict(0.0, limited, Stop(self.fault.what, fell=True))
        return Verdict(0.0, limited, Stop(str(self.fault), fell=False, fault=True))


class _RampOut:
    """From a torque [N m] to none, linear in time [s]."""

    def __init__(self, began: float, torque: float, duration: float) -> None:
        self._began, self._torque, self._duration = began, torque, duration

    def torque(self, time: float) -> float | None:
        """None when it is over."""
        left = 1.0 - (time - self._began) / self._duration
        return left * self._torque if left > 0.0 else None


_FELL, _OF_THE_BAR = 23, (8, 9)
_HOT = 1.1  # of the continuous rating: here scaling down did not help
