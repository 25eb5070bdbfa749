"""The optimal path follower: linear-quadratic gains on all that moves, and preview of the path."""

from typing import Any

import numpy as np

from bikesim.errors import InputError
from bikesim.model.real import Real
from bikesim.model.transition import transition
from bikesim.rider.base import Setting, Sight
from bikesim.rider.figures import each_of, elementwise
from bikesim.rider.lqr_design import Design, FeedForward, Figures, design

_SLOWEST = 0.5  # m/s
_NEAR = 0.05  # m/s, how far the speed may be from that of the gains


class Lqr:
    """u = -K x + the feed-forward of the curvature ahead; see `bikesim.rider.lqr_design`.

    He knows bicycle, law and rig, his arms, and the torque that his muscles make of what he
    intends, but no delay and no noise. `preview_time` T_p [s] is how far ahead he looks, no farther
    than the display shows; all figures are as in `Figures`. Gains and feed-forward are for the
    speed at the start. Once the speed has left it by 0.05 m/s they are for the nearest tenth of a
    m/s, below 0.5 m/s for 0.5; to start more slowly raises InputError.
    """

    def __init__(
        self,
        setting: Setting,
        *,
        lateral_weight: Real = 1.0,
        heading_weight: Real = 1.0,
        effort_weight: Real = 1.0,
        preview_time: Real = 3.0,
        muscle_frequency: Real = 0.0,
        muscle_damping_ratio: Real = 0.707,
        arm_inertia: Real = 0.0,
        arm_damping: Real = 0.0,
        arm_stiffness: Real = 0.0,
    ) -> None:
        if np.any(np.less(setting.speed, _SLOWEST)):
            raise InputError(
                f"rider lqr: speed = {np.min(setting.speed):g} m/s: must be at least "
                f"{_SLOWEST:g} m/s at the start"
            )
        self._setting = setting
        self._figures = Figures(
            lateral_weight, heading_weight, effort_weight, _least(preview_time, setting.preview),
            muscle_frequency, muscle_damping_ratio, arm_inertia, arm_damping, arm_stiffness,
        )  # fmt: skip
        self._muscle = _Efference(muscle_frequency, muscle_damping_ratio, setting.step)
        self._designs: dict[tuple[float, ...], Design] = {}
        self._seen: Sight | None = None
        self._base: Real = 0.0
        self._take(setting.speed)

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """One physics step; see the class."""
        if seen is not self._seen:
            self._look(seen)
        _, _, _, k_delta, _, k_delta_dot, k_torque, k_torque_rate = self._gains
        muscle = self._muscle
        intended = (
            self._base
            - k_delta * steer
            - k_delta_dot * steer_rate
            - k_torque * muscle.torque
            - k_torque_rate * muscle.torque_rate
        )
        muscle.step(intended)
        return intended

    def _look(self, seen: Sight) -> None:
        """What a sight changes."""
        self._seen = seen
        speed = _most(seen.speed, _SLOWEST)
        far = abs(speed - self._speed) > _NEAR
        if far.any() if isinstance(far, np.ndarray) else far:
            self._take(_nearest(speed, self._speed))
        k_lateral, k_heading, k_phi, _, k_phi_dot, *_ = self._gains
        self._base = (
            self._forward(seen.station)
            - k_lateral * seen.deviation
            - k_heading * seen.heading_error
            - k_phi * seen.roll
            - k_phi_dot * seen.roll_rate
        )

    def _take(self, speed: Real) -> None:
        """Gains and feed-forward for a speed [m/s]."""
        self._speed = speed
        columns = (speed, *self._figures)
        count = max(np.size(one) for one in columns)
        rows = list(zip(*(each_of(count, one) for one in columns), strict=True))
        place = {row: i for i, row in enumerate(dict.fromkeys(rows))}
        for row in place:
            if row not in self._designs:
                self._designs[row] = design(self._setting, row[0], Figures(*row[1:]))
        designs = [self._designs[row] for row in place]
        alone = all(np.ndim(one) == 0 for one in columns)
        which: Any = 0 if alone else np.array([place[row] for row in rows])
        gains = np.array([one.gains for one in designs])[which]
        self._gains = tuple(gains.tolist() if alone else gains.T.copy())
        self._forward = FeedForward(self._setting.path, designs, which)


class _Efference:
    """What the muscles make of what is intended, as their owner knows it: as `Neuromuscular`.

    `torque` [N m] and its rate [N m/s]; zero for muscles without lag (of frequency 0), which the
    state of the design does not have.
    """

    def __init__(self, frequency: Real, damping_ratio: Real, step: float) -> None:
        self._matrix = elementwise(lambda w, z: _matrix(w, z, step), frequency, damping_ratio)
        self.torque: Real = 0.0
        self.torque_rate: Real = 0.0

    def step(self, intended: Real) -> None:
        """One step of the intended torque [N m]."""
        P11, P12, P21, P22, D1, D2 = self._matrix
        torque, rate = self.torque, self.torque_rate
        self.torque = P11 * torque + P12 * rate + D1 * intended
        self.torque_rate = P21 * torque + P22 * rate + D2 * intended


def _matrix(frequency: float, damping_ratio: float, step: float) -> tuple[float, ...]:
    stiffness, damping = frequency**2, 2 * damping_ratio * frequency
    P11, P12, P21, P22, _, A12, _, A22, _, B12, _, B22 = transition(step, stiffness, damping)
    return P11, P12, P21, P22, stiffness * (A12 + B12), stiffness * (A22 + B22)


def _nearest(speed: Real, before: Real) -> Real:
    """The nearest tenth of a m/s, but what it was before where it is still near that."""
    tenth = (10 * speed + 0.5) // 1 / 10
    if not isinstance(tenth, np.ndarray):
        return tenth
    return np.where(abs(speed - before) > _NEAR, tenth, before)


def _least(a: Real, b: Real) -> Real:
    return np.minimum(a, b) if np.ndim(a) or np.ndim(b) else float(min(a, b))


def _most(a: Real, b: float) -> Real:
    return np.maximum(a, b) if isinstance(a, np.ndarray) else max(a, b)
