"""What stands between the law and a person's arms: limits, and reasons to stop."""

import math
from typing import Annotated, ClassVar, NamedTuple

from pydantic import Field

from bikesim.model.real import Real
from bikesim.settings import Settings

CLAMPED, SLEWED, REFUSED = 1, 2, 4

# A bar this close to its stop [rad] (half a degree) counts as at it.
_STOP_MARGIN = 0.0087


class GuardSettings(Settings):
    """Limits that hold whatever the model computes."""

    table: ClassVar[str] = "guard"

    torque_limit: Annotated[float, Field(gt=0, le=100)] = Field(
        default=10.0, description="Largest feedback torque [N m]."
    )
    torque_rate_limit: Annotated[float, Field(gt=0, le=1e6)] = Field(
        default=300.0, description="Fastest change of the feedback torque [N m/s]."
    )
    fall_roll_deg: Annotated[float, Field(gt=0, lt=90)] = Field(
        default=45.0, description="Roll beyond which the bicycle has fallen [deg]."
    )


class Stop(NamedTuple):
    """Why a run must end. A fall is a result; a fault is an error."""

    reason: str
    fell: bool
    fault: bool = False


class Verdict(NamedTuple):
    """The torque [N m] that may go out, how it was limited (a bit mask), and whether to stop.

    Of a batch: arrays, and a stop where all have stopped.
    """

    torque: Real
    limited: Real
    stop: Stop | None


class Guard:
    """Checks each tick's torque; `period` [s] between ticks, `steer_stop` [rad] of the rig.

    A torque is clamped, then slewed from the last allowed one; from zero at the start. One that
    is not finite is refused and stops the run, as do a fallen bicycle and a bar at its stop; the
    torque of a tick that stops is zero.
    """

    def __init__(self, settings: GuardSettings, period: float, steer_stop: float) -> None:
        self._limit = settings.torque_limit
        self._step = settings.torque_rate_limit * period
        self._fall = math.radians(settings.fall_roll_deg)
        self._stop = steer_stop - _STOP_MARGIN
        self._last = 0.0

    def check(self, steer: float, roll: float, torque: float) -> Verdict:
        """For the measured steer angle [rad], the roll [rad] and T_f of eq. 6 [N m]."""
        stop = self.reason_to_stop(steer, roll, torque)
        if stop is not None:
            self._last = 0.0
            return Verdict(0.0, REFUSED, stop)
        limited = 0
        if torque > self._limit:
            torque, limited = self._limit, CLAMPED
        elif torque < -self._limit:
            torque, limited = -self._limit, CLAMPED
        change = torque - self._last
        if change > self._step:
            torque, limited = self._last + self._step, limited | SLEWED
        elif change < -self._step:
            torque, limited = self._last - self._step, limited | SLEWED
        self._last = torque
        return Verdict(torque, limited, None)

    @property
    def limits(self) -> tuple[float, float, float, float]:
        """Torque [N m], its change in a tick [N m], roll [rad], steer [rad]."""
        return self._limit, self._step, self._fall, self._stop

    def reason_to_stop(self, steer: float, roll: float, torque: float) -> Stop | None:
        """A torque that is not finite, a fall, the bar at its stop; in this order."""
        if not math.isfinite(torque):
            return _fault("feedback torque", torque)
        if not -self._fall <= roll <= self._fall:
            return self._fallen(roll)
        if not -self._stop <= steer <= self._stop:
            return _at_stop(steer)
        return None

    def _fallen(self, roll: float) -> Stop:
        if not math.isfinite(roll):
            return _fault("roll", roll)
        side = "right" if roll > 0 else "left"
        return Stop(
            f"fell to the {side}: roll beyond {math.degrees(self._fall):.0f} deg", fell=True
        )


def _fault(what: str, value: float) -> Stop:
    return Stop(f"fault: {what} is {value}", fell=False, fault=True)


def _at_stop(steer: float) -> Stop:
    if not math.isfinite(steer):
        return _fault("steer", steer)
    side = "right" if steer > 0 else "left"
    return Stop(f"fell: the bar hit its {side} stop", fell=True)
