"""The bar as it is identified: what it does of a torque that was sent, many guesses at once.

I δ̈ = u(t - d) + c - b δ̇ - f, with friction f of at most F that would bring the bar to rest within a
short time τ_s: f = u + c + I δ̇ / τ_s between -F and F. For τ_s → 0 that is Coulomb's law with its
sticking; no real (nor MuJoCo's) friction turns around at once, and what is left out of the turn
would be taken for inertia. The rate sensor says δ̇ + r. What is sent, u, counts as real torque
unless the ratio of both is a guess too.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError

Reals = NDArray[np.float64]


class BarRecord(NamedTuple):
    """What was sent to a bar and what it did, hands off, a row a tick; SI, right positive.

    `time` (n,) [s], `torque` (n,) [N m] sent then and held to the next tick, `steer` (n,) [rad] and
    `steer_rate` (n,) [rad/s] as measured. `added_inertia` [kg m²]: of weights put on for this one.
    """

    time: Reals
    torque: Reals
    steer: Reals
    steer_rate: Reals
    added_inertia: float = 0.0


class Guess(NamedTuple):
    """What is sought, each (g, 1): a row a guess.

    `inertia` [kg m²], `coulomb_friction` F [N m], `viscous_friction` b [N m s/rad], `delay` d [s],
    `offset` c [N m], `rate_bias` r [rad/s], `sticking_time` τ_s [s] beyond a step of the record,
    `torque_ratio`: real torque over what was sent.
    """

    inertia: Reals
    coulomb_friction: Reals
    viscous_friction: Reals
    delay: Reals
    offset: Reals
    rate_bias: Reals
    sticking_time: Reals
    torque_ratio: Reals


SEGMENT = 0.5
"""Pieces of so long [s] are followed, each from a state of its own: what a model leaves out must
not add up for long."""


class Segments:
    """A record in pieces of equal length, s of them with m samples each."""

    def __init__(self, record: BarRecord) -> None:
        self.record = record
        if not all(np.isfinite(column).all() for column in record[:4]):
            raise InputError("the record of the bar has values that are no finite numbers")
        steps = np.diff(record.time)
        if len(record.time) < 50 or not (steps > 0).all():
            raise InputError("the record of the bar is too short, or its time goes back")
        self.m = max(20, round(SEGMENT / float(np.median(steps))))
        self.s = len(record.time) // self.m
        if self.s < 8:
            raise InputError(f"the record of the bar is too short: at least {8 * SEGMENT:g} s")
        used = self.s * self.m
        self.steer = record.steer[:used].reshape(self.s, self.m)
        self.steer_rate = record.steer_rate[:used].reshape(self.s, self.m)
        ends = np.append(record.time, 2 * record.time[-1] - record.time[-2])
        self._time = ends[: used + 1]
        self.steps = np.diff(self._time).reshape(self.s, self.m)
        # ∫u dt at the ticks; straight between them, as u is held.
        self._ticks = ends
        self._sum = np.append(0.0, np.cumsum(record.torque * np.diff(ends)))

    def torque(self, delay: float) -> Reals:
        """The mean of u(t - d) over each step, (s, m)."""
        total = np.interp(self._time - delay, self._ticks, self._sum)
        return np.diff(total).reshape(self.s, self.m) / self.steps

    def follow(self, guesses: Guess, steer: Reals, steer_rate: Reals) -> tuple[Reals, Reals]:
        """Measured angle and rate (g, s, m) that g guesses give, each from a state (g, s) of its
        own at the beginning of each piece.
        """
        torque = np.stack([self.torque(float(d)) for d in guesses.delay[:, 0]])
        torque = guesses.torque_ratio[:, :, None] * torque + guesses.offset[:, :, None]
        torque = np.ascontiguousarray(np.moveaxis(torque, 2, 0))
        inertia = guesses.inertia + self.record.added_inertia
        most, least = guesses.coulomb_friction, -guesses.coulomb_friction
        angle, rate = np.empty_like(torque), np.empty_like(torque)
        for k, h in enumerate(self.steps.T):
            angle[k], rate[k] = steer, steer_rate
            # Within a step more: with τ_s = 0 Coulomb's law, implicitly, which turns no bar around.
            stopping = torque[k] + inertia / (guesses.sticking_time + h) * steer_rate
            friction = np.minimum(np.maximum(stopping, least), most)
            # Implicit in the damping too, so that no guess runs away.
            per_torque = h / inertia
            pushed = steer_rate + per_torque * (torque[k] - friction)
            after = pushed / (1.0 + per_torque * guesses.viscous_friction)
            steer = steer + 0.5 * h * (steer_rate + after)
            steer_rate = after
        rate += guesses.rate_bias
        return np.moveaxis(angle, 0, 2), np.moveaxis(rate, 0, 2)
