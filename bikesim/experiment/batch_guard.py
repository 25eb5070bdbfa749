"""The guard of many rigs at once: each is limited and stopped as `Guard` would, bit for bit."""

import numpy as np
from numpy.typing import NDArray

from bikesim.guard import CLAMPED, REFUSED, SLEWED, Guard, GuardSettings, Stop, Verdict
from bikesim.rig.batch import Riding


class BatchGuard:
    """Checks each tick's torques, arrays (n,), and ends the riding of those that must stop.

    `stops` holds for each rig why and at which tick it stopped, None while it rides.
    """

    def __init__(
        self, settings: GuardSettings, period: float, steer_stop: float, riding: Riding
    ) -> None:
        self._one = Guard(settings, period, steer_stop)
        limits = self._one.limits
        self._limit, self._step, self._fall, self._stop = limits
        self._riding = riding
        self._last: NDArray[np.float64] = np.zeros(len(riding.mask))
        self._tick = -1
        self.stops: list[tuple[Stop, int] | None] = [None] * len(riding.mask)

    def check(
        self,
        steer: NDArray[np.float64],
        roll: NDArray[np.float64],
        torque: NDArray[np.float64],
    ) -> Verdict:
        """As `Guard.check`; the stop is that of the last rig, when none is left."""
        self._tick += 1
        sound = np.isfinite(torque) & (abs(roll) <= self._fall) & (abs(steer) <= self._stop)
        clamped = np.minimum(np.maximum(torque, -self._limit), self._limit)
        change = clamped - self._last
        allowed, limited = clamped, CLAMPED * (clamped != torque)
        if not (abs(change) <= self._step).all():
            faster, slower = change > self._step, change < -self._step
            allowed = np.where(faster, self._last + self._step, clamped)
            allowed = np.where(slower, self._last - self._step, allowed)
            limited = limited | SLEWED * (faster | slower)
        stop = None
        if not sound.all():
            stopped = self._riding.mask & ~sound
            if stopped.any():
                stop = self._end(stopped, steer, roll, torque)
        if self._riding.ids is not None:
            allowed = np.where(self._riding.mask, allowed, 0.0)
            limited = np.where(self._riding.mask, limited, REFUSED)
        self._last = allowed
        return Verdict(allowed, limited, stop)

    def _end(
        self,
        stopped: NDArray[np.bool_],
        steer: NDArray[np.float64],
        roll: NDArray[np.float64],
        torque: NDArray[np.float64],
    ) -> Stop | None:
        stop = None
        for i in np.flatnonzero(stopped):
            stop = self._one.reason_to_stop(float(steer[i]), float(roll[i]), float(torque[i]))
            assert stop is not None
            self.stops[i] = (stop, self._tick)
        self._riding.stop(stopped)
        return None if self._riding.count else stop
