"""What pushes and disturbances do to the bicycle: T_φ and T_δ, tick by tick."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.multisine import Multisine
from bikesim.experiment.scenario import Push, Scenario
from bikesim.experiment.speed import SpeedProfile
from bikesim.experiment.wind import Gust, Turbulence, side_force
from bikesim.loop import Moments
from bikesim.model.bicycle import Bicycle

Array = NDArray[np.float64]

BLOCK = 1024  # ticks that are computed at once


class DisturbanceMoments:
    """T_φ and T_δ [N m] of a scenario's pushes and disturbances, in blocks of ticks."""

    def __init__(self, scenario: Scenario, bicycle: Bicycle) -> None:
        self._scenario, self._bicycle = scenario, bicycle
        self._speed = SpeedProfile(scenario)
        self._pushes = [(push, moments_per_newton(push, bicycle)) for push in scenario.pushes]
        self._sources = _sources(scenario, bicycle)
        self._next = 0
        self.none = not self._pushes and not self._sources

    def block(self, number: int) -> Array:
        """(2, BLOCK) [N m]: T_φ and T_δ of the ticks from number · BLOCK on."""
        # Turbulence goes on from block to block; whoever goes back begins again.
        if number < self._next:
            self._sources, self._next = _sources(self._scenario, self._bicycle), 0
        if self._sources:
            for skipped in range(self._next, number):
                self._computed(skipped)
        self._next = number + 1
        return self._computed(number)

    def _computed(self, number: int) -> Array:
        moments = np.zeros((2, BLOCK))
        for push, per_newton in self._pushes:
            self._add(push, per_newton, number * BLOCK, moments)
        if self._sources:
            ticks = np.arange(float(number * BLOCK), float((number + 1) * BLOCK))
            time = self._scenario.period * ticks
            speed = self._speed.at(time)
            for source in self._sources:
                size = source.size(time, speed)
                moments[0] += size * source.per_one.roll
                moments[1] += size * source.per_one.steer
        return moments

    def _add(self, push: Push, per_newton: Moments, first: int, moments: Array) -> None:
        period = self._scenario.period
        begin = max(0, int(push.time / period) - first)
        end = min(BLOCK, int((push.time + push.duration) / period) + 2 - first)
        for i in range(begin, end):
            force = push_force(push, (first + i) * period)
            moments[0, i] += force * per_newton.roll
            moments[1, i] += force * per_newton.steer


class _Source(NamedTuple):
    """A disturbance: its size at times (n,) and speeds, and T_φ and T_δ of one of that size."""

    size: Callable[[Array, Array | float], Array]
    per_one: Moments


def _sources(scenario: Scenario, bicycle: Bicycle) -> list[_Source]:
    return [
        _source(one, scenario, bicycle, _random(scenario, i))
        for i, one in enumerate(scenario.disturbances)
    ]


def _source(
    one: Disturbance, scenario: Scenario, bicycle: Bicycle, random: np.random.Generator
) -> _Source:
    s: Any = one  # the figures of its kind are there
    if one.kind.endswith("multisine"):
        torque = Multisine(one, scenario.period, random)
        per_one = Moments(roll=1.0) if one.kind.startswith("roll") else Moments(steer=1.0)
        return _Source(lambda time, _: torque(time), per_one)
    if one.kind == "gust":
        wind: Callable[[Array], Array] = Gust(one)
    else:
        wind = Turbulence(one, SpeedProfile(scenario)(s.start), scenario.period, random)
    return _Source(
        lambda time, speed: side_force(one, wind(time), speed),
        moments_at(s.height, s.ahead, bicycle),
    )


def _random(scenario: Scenario, which: int) -> np.random.Generator:
    """Of a disturbance alone; the seed's first two children are the rider's and the sensors'."""
    return np.random.default_rng(np.random.SeedSequence(scenario.seed, spawn_key=(2, which)))


def multisines(scenario: Scenario) -> list[tuple[str, Multisine]]:
    """The multisines among a scenario's disturbances, with the phases that its seed gives.

    Each with its kind, roll-multisine (T_φ) or steer-multisine (T_δ).
    """
    return [
        (one.kind, Multisine(one, scenario.period, _random(scenario, i)))
        for i, one in enumerate(scenario.disturbances)
        if one.kind.endswith("multisine")
    ]


def push_force(push: Push, time: float) -> float:
    """The lateral force [N] at a time [s]: half a sine whose integral is the impulse."""
    phase = (time - push.time) / push.duration
    if not 0 < phase < 1:
        return 0.0
    return push.impulse * math.pi / (2 * push.duration) * math.sin(math.pi * phase)


def moments_per_newton(push: Push, bicycle: Bicycle) -> Moments:
    """T_φ and T_δ [N m] of one newton to the right at the push's point of the rear frame."""
    return moments_at(push.height, push.ahead, bicycle)


def moments_at(height: float, ahead: float, bicycle: Bicycle) -> Moments:
    """T_φ and T_δ [N m] of one newton to the right at a point of the rear frame [m].

    By virtual work: a roll moves the point by height · φ to the right, and steering at rest yaws
    the rear frame about its contact by c cos λ / w (eq. 8), which moves it by that times `ahead`.
    """
    yaw_per_steer = bicycle.trail * math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase
    return Moments(roll=height, steer=ahead * yaw_per_steer)
