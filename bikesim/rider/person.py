"""A person at the bar: senses → brain → strength → muscles → remnant → grip."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.rider.base import Arms, Brain, Sight
from bikesim.rider.delay import Late
from bikesim.rider.grip import Grip
from bikesim.rider.muscle import Neuromuscular, Strength
from bikesim.rider.noise import Noise
from bikesim.rider.senses import Balance, Display, Eyes, Felt, Hands, on_the_line


class _Torque(Protocol):
    def __call__(self, steer: Real, steer_rate: Real, seen: BicycleState) -> Real: ...


@dataclass(frozen=True)
class Body:
    """Everything human around a brain, in the order in which signals pass; None: nothing there.

    `display`, `eyes`, `seen_late`, `balance`: on the way to a Sight; `hands`, `felt_late`: to what
    is felt of the bar; `strength`, `muscle`, `remnant`: from intention to torque; `grip`: by time.
    """

    display: Display
    arms: Arms
    eyes: Eyes | None = None
    seen_late: Late | None = None
    balance: Balance | None = None
    hands: Hands | None = None
    felt_late: Late | None = None
    strength: Strength | None = None
    muscle: Neuromuscular | None = None
    remnant: Noise | None = None
    grip: Grip | None = None


class Person:
    """A brain in a body, one of a virtual rig or of each of a batch; a `Rider`."""

    def __init__(self, brain: Brain, body: Body) -> None:
        self.arms = body.arms
        self._body, self._intend = body, brain.intend
        self._shown: BicycleState | None = None
        self._sight = body.display.last
        rare = body.eyes, body.balance, body.hands, body.felt_late, body.strength, body.grip
        if not any(rare):
            self.torque = _plain(brain, body)

    def torque(self, steer: Real, steer_rate: Real, seen: BicycleState) -> Real:
        """The torque [N m] on the bar for the coming physics step; see `Rider`."""
        body = self._body
        if seen is not self._shown:
            self._shown, self._sight = seen, body.display(seen)
            if body.grip is not None:
                self._hold(body.grip, seen.time)
        sight, felt = self._sensed(self._sight, Felt(steer, steer_rate), seen)
        torque = self._intend(*felt, sight)
        if body.strength is not None:
            torque = body.strength(torque)
        if body.muscle is not None:
            torque = body.muscle.follow(torque)
        if body.remnant is not None:
            torque = torque + next(body.remnant)
        return torque if body.grip is None else _of_hands(body.grip.holding, torque)

    def _sensed(self, sight: Sight, felt: Felt, seen: BicycleState) -> tuple[Sight, Felt]:
        body = self._body
        if body.eyes is not None:
            sight = body.eyes(sight)
        if body.seen_late is not None:
            sight = body.seen_late(sight)
        if body.balance is not None:
            sight = body.balance(sight, seen)
        if body.hands is not None:
            felt = body.hands(felt)
        return sight, felt if body.felt_late is None else body.felt_late(felt)

    def _hold(self, grip: Grip, time: float) -> None:
        """Takes the bar or lets it go. Hands that come back begin with muscles at rest."""
        if grip.changed(time):
            self.arms = grip.arms
            if self._body.muscle is not None:
                self._body.muscle.relax(grip.taking)


def _plain(brain: Brain, body: Body) -> _Torque:
    """`Person.torque` of a body with none of the rarer parts, for what a tick costs."""
    display = on_the_line if body.display.plain else body.display
    late, remnant = body.seen_late, body.remnant
    intend, follow = brain.intend, None if body.muscle is None else body.muscle.follow
    shown, sight = None, body.display.last

    def torque(steer: Real, steer_rate: Real, seen: BicycleState) -> Real:
        nonlocal shown, sight
        if seen is not shown:
            shown, sight = seen, display(seen)
        torque = intend(steer, steer_rate, sight if late is None else late(sight))
        if follow is not None:
            torque = follow(torque)
        return torque if remnant is None else torque + next(remnant)

    return torque


def _of_hands(holding: Real, torque: Real) -> Real:
    """No torque of hands that are off the bar."""
    if isinstance(torque, float):
        return torque if holding else 0.0
    return np.where(holding, torque, 0.0)
