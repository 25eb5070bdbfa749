"""What reaches a rider's brain: by the display and his eyes, his balance organs, his hands."""

from collections.abc import Callable
from functools import partial
from itertools import repeat
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.path.path import Path
from bikesim.rider.base import Sight
from bikesim.rider.delay import Late
from bikesim.rider.noise import Noise
from bikesim.rider.schedule import Schedule

_TURN = 2 * np.pi
_pick = itemgetter(
    *map(
        BicycleState._fields.index,
        ("time", "speed", "roll", "roll_rate", "heading", "x", "y", "heading"),
    )
)
# As Sight._make, which counts them each time: this is done at every tick.
_made: Callable[[tuple[Real, ...]], Sight] = partial(tuple.__new__, Sight)


def on_the_line(shown: BicycleState) -> Sight:
    """The bicycle beside the straight line: station x, deviation y, and all heading is error."""
    return _made(_pick(shown))


class Felt(NamedTuple):
    """The bar as the hands feel it: `steer` [rad], `steer_rate` [rad/s]."""

    steer: Real
    steer_rate: Real


class Turned(NamedTuple):
    """The roll rate [rad/s] that the balance organs feel."""

    roll_rate: Real


class Display:
    """The picture, where it shows the path too: bicycle shown → Sight, once a tick.

    Without the roll cue (0 in place of 1) the horizon stays level. In the dark (`light` is 0) the
    sight stays what it was: `last`, at first `before`. `plain` if there is nothing of all this.
    """

    def __init__(self, path: Path, before: Sight, roll_cue: Real, light: Schedule | None) -> None:
        self._path = None if path.straight else path
        self.last, self._station = before, before.station
        self._roll_cue = None if np.all(roll_cue == 1.0) else roll_cue
        self._light = light
        self.plain = self._path is self._roll_cue is light is None

    def __call__(self, shown: BicycleState) -> Sight:
        """What is to be seen of it."""
        sight = on_the_line(shown)
        if self._path is not None:
            sight = self._beside(self._path, sight)
        if self._roll_cue is not None:
            roll, roll_rate = self._roll_cue * sight.roll, self._roll_cue * sight.roll_rate
            sight = sight._replace(roll=roll, roll_rate=roll_rate)
        if self._light is not None:
            sight = self.last = self._lit(sight, self._light)
        return sight

    def _beside(self, path: Path, sight: Sight) -> Sight:
        self._station, deviation, along = path.place(sight.station, sight.deviation, self._station)
        error = _within_a_turn(sight.heading - along)
        return Sight(*sight[:5], self._station, deviation, error)

    def _lit(self, sight: Sight, light: Schedule) -> Sight:
        lit = light(sight.time)
        if isinstance(lit, float):
            return sight if lit else self.last
        return Sight._make(
            np.where(lit, now, last) for now, last in zip(sight, self.last, strict=True)
        )


class Eyes:
    """Noise on what is seen, at every physics step; Sight → Sight.

    On roll [rad], roll rate [rad/s], heading [rad] and deviation [m], in this order.
    """

    def __init__(self, *noises: Noise | None) -> None:
        self._noises = [noise or repeat(0.0) for noise in noises]

    def __call__(self, sight: Sight) -> Sight:
        """With noise."""
        on_roll, on_roll_rate, on_heading, on_deviation = map(next, self._noises)
        time, speed, roll, roll_rate, heading, station, deviation, heading_error = sight
        return Sight(
            time,
            speed,
            roll + on_roll,
            roll_rate + on_roll_rate,
            heading + on_heading,
            station,
            deviation + on_deviation,
            heading_error + on_heading,
        )


class Hands:
    """Noise on what is felt, at every physics step: on steer [rad] and steer rate [rad/s]."""

    def __init__(self, *noises: Noise | None) -> None:
        self._noises = [noise or repeat(0.0) for noise in noises]

    def __call__(self, felt: Felt) -> Felt:
        """With noise."""
        on_steer, on_steer_rate = map(next, self._noises)
        return Felt(felt.steer + on_steer, felt.steer_rate + on_steer_rate)


class Balance:
    """The balance organs: a `share` (0 to 1) of the roll rate that a rider perceives.

    They feel the bicycle's own roll rate, with `noise` [rad/s] and `late`, whatever is displayed.
    """

    def __init__(self, share: Real, noise: Noise | None, late: Late | None) -> None:
        self._share, self._noise, self._late = share, noise, late

    def __call__(self, sight: Sight, bicycle: BicycleState) -> Sight:
        """The sight with the perceived roll rate."""
        felt = bicycle.roll_rate
        if self._noise is not None:
            felt = felt + next(self._noise)
        if self._late is not None:
            (felt,) = self._late(Turned(felt))
        time, speed, roll, seen, *rest = sight
        return Sight(time, speed, roll, (1.0 - self._share) * seen + self._share * felt, *rest)


def _within_a_turn(angle: Real) -> Real:
    """From -π to π."""
    turns = angle / _TURN
    return angle - _TURN * (float(round(turns)) if isinstance(turns, float) else np.rint(turns))
