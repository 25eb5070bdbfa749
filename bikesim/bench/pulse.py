"""The commissioning pulse: a small torque one way and the other, hands off (row 22).

What the bar does of it proves, before any larger torque, that signs, units and inertia are those
of the profile.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from bikesim.bench.faults import Thresholds
from bikesim.bench.guard import BenchGuard, TorqueLimits
from bikesim.bench.profile import BarSettings
from bikesim.bench.rig import BenchRig
from bikesim.errors import InputError

MOST_TORQUE = 0.3
"""Of the pulse [N m]."""

ALIKE = 0.7, 1.3
"""What the bar's inertia may be of that in the profile, for a ride."""

GROSSLY = 1 / 3, 3.0
"""And for a bar that is yet to be identified: signs, units and gear are right, more is unknown."""

_DURATION = 0.08  # s, each way
_RATE = 0.3  # rad/s, that the bar is to reach
_SETTLE = 0.3  # s


class Moment(NamedTuple):
    """A tick: time [s], torque commanded and measured [N m], steer rate [rad/s]."""

    time: float
    sent: float
    measured: float
    steer_rate: float


class Pulse(NamedTuple):
    """What the bar did: inertia [kg m²] and the torque measured over that commanded."""

    inertia: float
    torque_ratio: float


def pulse_torque(bar: BarSettings) -> float:
    """Enough to move the bar against its friction, not more than 0.3 N m."""
    return min(MOST_TORQUE, bar.coulomb_friction + bar.inertia * _RATE / _DURATION)


def send_pulse(
    rig: BenchRig,
    bar: BarSettings,
    limits: TorqueLimits,
    thresholds: Thresholds,
    heartbeat_period: float,
    *,
    torque: float | None = None,
    allowed: tuple[float, float] = ALIKE,
) -> Pulse:
    """On an armed rig at rest. Raises InputError where the bar contradicts the profile.

    `torque` [N m], default: as large as this bar needs; `allowed`: see `ALIKE`.
    """
    torque = pulse_torque(bar) if torque is None else min(torque, MOST_TORQUE)
    moments = excite(rig, _both_ways(torque), 2 * _DURATION, limits, thresholds, heartbeat_period)
    excite(rig, lambda time: 0.0, _SETTLE, limits, thresholds, heartbeat_period)
    return judged(moments, bar, torque, allowed)


def _both_ways(torque: float):
    def at(time: float) -> float:
        return torque if time < _DURATION else -torque

    return at


def excite(
    rig: BenchRig,
    torque,
    duration: float,
    limits: TorqueLimits,
    thresholds: Thresholds,
    heartbeat_period: float,
) -> list[Moment]:
    """Puts a torque(time) [N m] on an armed bar, the guard in force; gives what it did.

    Raises InputError for a fault; the rig is then to be closed.
    """
    rig.begin()
    guard = BenchGuard(
        limits,
        thresholds.model_copy(update={"ramp_in": 1e-6}),
        period=rig.info.period,
        heartbeat_period=heartbeat_period,
        observe=rig.observation,
    )
    moments: list[Moment] = []
    while True:
        time, steer, steer_rate = rig.read()
        if time >= duration:
            return moments
        allowed, _, stop = guard.check(steer, 0.0, torque(time))
        measured = rig.drive_view.torque
        sent = rig.command(allowed)
        if stop is not None:
            raise InputError(stop.reason)
        moments.append(Moment(time, sent, measured, steer_rate))
        rig.wait()


def judged(
    moments: Sequence[Moment],
    bar: BarSettings,
    torque: float,
    allowed: tuple[float, float] = ALIKE,
) -> Pulse:
    """The inertia that the first half shows, friction allowed for. Raises InputError (row 22)."""
    # What is late, and the slewing at the beginning, stay out.
    late = 0.01 + bar.delay
    half = [m for m in moments if late <= m.time < _DURATION]
    if len(half) < 3:
        raise InputError("fault 22: too few ticks in the commissioning pulse")
    slope, rate = _slope(half)
    friction = bar.coulomb_friction + bar.viscous_friction * abs(rate)
    expected = (torque - friction) / bar.inertia
    measured = sum(m.measured for m in half) / len(half)
    if measured * torque <= 0 or abs(measured - torque) > 0.5 * torque:
        raise InputError(
            f"fault 22: the drive measures {measured:+.3f} N m where {torque:+.3f} were commanded; "
            "sign or unit of its torque is wrong"
        )
    if abs(slope) < 0.1 * expected:
        raise InputError(
            f"fault 22: the bar hardly moves under {torque:.2f} N m: {slope:+.2f} rad/s² for "
            f"{expected:+.2f}; is it held, or the drive without power?"
        )
    if slope < 0:
        raise InputError(
            f"fault 22: the bar turns left under a torque to the right ({slope:+.2f} rad/s²): "
            "drive.direction, or the sign of the sensors, is wrong"
        )
    inertia = (torque - friction) / slope
    low, high = allowed
    if not low <= inertia / bar.inertia <= high:
        raise InputError(
            f"fault 22: the bar moves as if its inertia were {inertia:.4f} kg m², the profile has "
            f"{bar.inertia:.4f}; allowed {low:.2g} to {high:.2g} of that: hands off? gear, torque "
            "unit?"
        )
    return Pulse(inertia, measured / torque)


def _slope(moments: Sequence[Moment]) -> tuple[float, float]:
    """Of the rate over time [rad/s²], least squares; and the mean rate [rad/s]."""
    n = len(moments)
    time = math.fsum(m.time for m in moments) / n
    rate = math.fsum(m.steer_rate for m in moments) / n
    up = math.fsum((m.time - time) * (m.steer_rate - rate) for m in moments)
    down = math.fsum((m.time - time) ** 2 for m in moments)
    return up / down, rate
