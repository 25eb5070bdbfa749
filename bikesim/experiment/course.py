"""Speed and disturbances of a scenario as the loop asks for them."""

import math
from bisect import bisect_right
from collections.abc import Sequence

from bikesim.experiment.scenario import Push, Scenario
from bikesim.loop import Moments
from bikesim.model.bicycle import Bicycle

_NO_PUSH = Moments()


class ScenarioCourse:
    """Constant or piecewise linear speed, and lateral pushes, by time [s]."""

    def __init__(self, scenario: Scenario, bicycle: Bicycle) -> None:
        self._constant = scenario.speed
        self._times = [time for time, _ in scenario.speed_profile]
        self._speeds = [speed for _, speed in scenario.speed_profile]
        self._pushes = [(push, moments_per_newton(push, bicycle)) for push in scenario.pushes]

    def speed(self, time: float) -> float:
        """Forward speed [m/s]; before the first and after the last given time, that one's."""
        if not self._times:
            return self._constant
        return _interpolated(time, self._times, self._speeds)

    def disturbance(self, time: float) -> Moments:
        """The generalised forces of all pushes [N m]."""
        if not self._pushes:
            return _NO_PUSH
        roll = steer = 0.0
        for push, per_newton in self._pushes:
            force = push_force(push, time)
            roll += force * per_newton.roll
            steer += force * per_newton.steer
        return Moments(roll, steer)


def push_force(push: Push, time: float) -> float:
    """The lateral force [N] at a time [s]: half a sine whose integral is the impulse."""
    phase = (time - push.time) / push.duration
    if not 0 < phase < 1:
        return 0.0
    return push.impulse * math.pi / (2 * push.duration) * math.sin(math.pi * phase)


def moments_per_newton(push: Push, bicycle: Bicycle) -> Moments:
    """T_φ and T_δ [N m] of one newton to the right at the push's point of the rear frame.

    By virtual work: a roll moves the point by height · φ to the right, and steering at rest yaws
    the rear frame about its contact by c cos λ / w (eq. 8), which moves it by that times `ahead`.
    """
    yaw_per_steer = bicycle.trail * math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase
    return Moments(roll=push.height, steer=push.ahead * yaw_per_steer)


def _interpolated(x: float, xs: Sequence[float], ys: Sequence[float]) -> float:
    i = bisect_right(xs, x)
    if i == 0:
        return ys[0]
    if i == len(xs):
        return ys[-1]
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])
