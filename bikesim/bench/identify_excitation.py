"""A small torque that a bar is identified with: sines, and a weak spring that keeps it centred."""

import math
from typing import NamedTuple, Protocol

import numpy as np

from bikesim.bench.identify_model import BarRecord
from bikesim.errors import InputError
from bikesim.guard import Verdict
from bikesim.model.haptic import BicycleState
from bikesim.rig.base import Sample

MOST_TORQUE = 0.5
"""Of the excitation [N m]."""

MOST_ANGLE, MOST_RATE = math.radians(25.0), 3.0
"""Where the bar is not to go: the excitation ends there [rad, rad/s]."""

_BASE = 0.2  # Hz, of which the lines are multiples
_LINES = (2, 3, 5, 7, 11, 17, 25, 37)  # prime or nearly so: friction's harmonics fall beside them
_CENTRING = 0.3  # of the torque, at the largest angle
_FADE = 0.5  # s


class Excitation:
    """A torque by time and state. Sines of 0.4 to 7.4 Hz with Schroeder's phases, faded in and out.

    `torque` [N m] at most, sines and centring together; `duration` [s].
    """

    def __init__(self, torque: float, duration: float, inertia: float) -> None:
        """`inertia` [kg m²] as it is thought to be, for the centring's damping."""
        if not 0 < torque <= MOST_TORQUE:
            raise InputError(f"torque = {torque} N m: must be above 0 and at most {MOST_TORQUE:g}")
        self.duration, self.torque = duration, torque
        self._waves = tuple(
            (2 * math.pi * _BASE * line, -math.pi * i * (i - 1) / len(_LINES))
            for i, line in enumerate(_LINES, start=1)
        )
        time = np.arange(0.0, 1 / _BASE, 1e-3)
        highest = float(np.abs(sum(np.sin(w * time + p) for w, p in self._waves)).max())
        self._amplitude = (1 - _CENTRING) * torque / highest
        self._stiffness = _CENTRING * torque / MOST_ANGLE
        self._damping = 0.6 * math.sqrt(self._stiffness * inertia)

    def __call__(self, time: float, steer: float, steer_rate: float) -> float:
        """At a time [s], angle [rad] and rate [rad/s]."""
        sines = sum(math.sin(w * time + p) for w, p in self._waves)
        faded = max(0.0, min(1.0, time / _FADE, (self.duration - time) / _FADE))
        torque = self._amplitude * sines - self._stiffness * steer - self._damping * steer_rate
        return faded * max(-self.torque, min(self.torque, torque))


class Bar(Protocol):
    """What of a rig is needed to excite a bar."""

    def read(self) -> Sample: ...
    def command(self, torque: float) -> float: ...
    def show(self, bicycle: BicycleState) -> None: ...
    def wait(self) -> None: ...


class Checks(Protocol):
    """A guard."""

    def check(self, steer: float, roll: float, torque: float) -> Verdict: ...


class _Moment(NamedTuple):
    time: float
    torque: float
    steer: float
    steer_rate: float


def excite(
    bar: Bar,
    guard: Checks,
    excitation: Excitation,
    resting: BicycleState,
    *,
    added_inertia: float = 0.0,
) -> BarRecord:
    """Puts the excitation on an armed bar at rest, hands off, the guard in force.

    `resting`: a bicycle to show meanwhile. Raises InputError where the guard stops or the bar goes
    too far; the rig is its owner's to close, however this is left.
    """
    rows: list[_Moment] = []
    while True:
        sample = bar.read()
        time, steer, steer_rate = sample
        if time > excitation.duration:
            break
        if abs(steer) > MOST_ANGLE or abs(steer_rate) > MOST_RATE:
            raise InputError(
                f"the bar went to {math.degrees(steer):+.0f} deg, {steer_rate:+.1f} rad/s: allowed "
                f"{math.degrees(MOST_ANGLE):.0f} deg, {MOST_RATE:g} rad/s; less torque, and begin "
                "with the bar straight"
            )
        allowed, _, stop = guard.check(steer, 0.0, excitation(*sample))
        sent = bar.command(allowed)
        if stop is not None:
            raise InputError(f"the excitation was stopped: {stop.reason}")
        rows.append(_Moment(time, sent, steer, steer_rate))
        bar.show(resting)
        bar.wait()
    columns = np.array(rows, float).T
    return BarRecord(*columns, added_inertia=added_inertia)
