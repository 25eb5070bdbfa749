"""The haptic bicycle: roll from measured steer, feedback torque for the bar (eq. 4, 6, 8).

Both laws are one expression. With p = M_φφ φ̇ + M_φδ δ̇ (see SCIENCE, "momentum form") write
q = p / M_φφ, so that φ̇ = q - m δ̇ with m = M_φδ / M_φφ, and

    q̇   = (T_φ - C_φφ φ̇ - C_φδ δ̇ - K_φφ φ - K_φδ δ) / M_φφ
    T_f = -(M_δφ q̇ + C_δφ φ̇ + C_δδ δ̇ + K_δφ φ + K_δδ δ) + T_δ

is the momentum law; the paper's law (eq. 4 and 6) is m = 0, where q = φ̇. Haptics off has T_f = 0.
T_φ and T_δ are disturbances on the bicycle (a gust, a push), zero otherwise.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.real import Real
from bikesim.model.transition import transition


class BicycleState(NamedTuple):
    """The simulated bicycle at a time, and the steer it was computed from. Floats, or arrays.

    SI and radians; roll > 0 leans right, steer and heading > 0 turn right, x forward, y right.
    `x`, `y`: rear contact [m]. `distance` travelled [m]. `feedback_torque` T_f [N m] on the bar.
    `roll_acceleration` is q̇: φ̈ under the paper's law, φ̈ + m δ̈ under the momentum law.
    `momentum` is q of the module's text [rad/s]; `roll_forcing`, `momentum_forcing` are what the
    next step interpolates from.
    """

    time: Real
    steer: Real
    steer_rate: Real
    speed: Real
    roll: Real
    roll_rate: Real
    roll_acceleration: Real
    heading: Real
    x: Real
    y: Real
    distance: Real
    feedback_torque: Real
    momentum: Real
    roll_forcing: Real
    momentum_forcing: Real


# Equal for all ticks of equal period and speed, so looked up: coefficients, then a transition.
_Coefficients = tuple[float, ...]


class HapticBicycle:
    """A bicycle under one law, as a function from state and measured steer to the next state.

    Pure: it keeps nothing of a ride. The same code takes floats (one rig) or arrays of equal
    shape (a batch).
    """

    def __init__(self, bicycle: Bicycle, law: Law) -> None:
        self.bicycle = bicycle
        self.law = law
        (M_pp, M_pd), (M_dp, _) = bicycle.matrices.M.tolist()
        self._M_pp, self._M_dp = M_pp, M_dp
        self._m = M_pd / M_pp if law is Law.MOMENTUM else 0.0
        self._C1, self._K0, self._K2 = (
            getattr(bicycle.matrices, name).tolist() for name in ("C1", "K0", "K2")
        )
        self._haptics = 0.0 if law is Law.OFF else 1.0
        self._cos_over_w = math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase
        self._trail = bicycle.trail
        self._cached = lru_cache(maxsize=4096, typed=True)(self._coefficients)
        self._speeds: Real = None
        self._of_step: dict[float, _Coefficients] = {}

    def start(
        self,
        *,
        time: Real = 0.0,
        steer: Real = 0.0,
        steer_rate: Real = 0.0,
        speed: Real = 0.0,
        roll: Real = 0.0,
        roll_rate: Real = 0.0,
        heading: Real = 0.0,
        roll_moment: Real = 0.0,
        steer_moment: Real = 0.0,
    ) -> BicycleState:
        """The state at the first sample; angles [rad], rates [rad/s], moments [N m]."""
        zero = 0.0 * (roll + roll_rate + steer + steer_rate + speed + roll_moment)
        before = BicycleState(
            time, steer, steer_rate, speed, roll, roll_rate, zero, zero + heading, zero, zero, zero,
            zero, roll_rate + self._m * steer_rate, zero, zero,
        )  # fmt: skip
        return self.step(before, time, steer, steer_rate, speed, roll_moment, steer_moment)

    def step(
        self,
        before: BicycleState,
        time: Real,
        steer: Real,
        steer_rate: Real,
        speed: Real,
        roll_moment: Real = 0.0,
        steer_moment: Real = 0.0,
    ) -> BicycleState:
        """The state at `time` [s], given what was measured then.

        Steer [rad] and its rate [rad/s] are taken linear between the samples, for which the roll
        is exact (first-order hold); φ̈ follows algebraically from eq. 4 at the new sample. The
        forward speed [m/s] and the disturbance T_φ, T_δ [N m] may change from step to step.
        Eq. 8 is integrated with the mean of both headings.
        """
        (
            t0, steer0, _, speed0, phi0, _, _, heading, x, y, distance, _, q0, e0, f0,
        ) = before  # fmt: skip
        h = time - t0
        try:
            coefficients = self._cached(h, speed)
        except TypeError:  # arrays are not hashable
            coefficients = self._cached_for_array(h, speed)
        (
            C_pp, C_pd, K_pp, K_pd, M_dp, C_dp, C_dd, K_dp, K_dd, m, M_pp, cos_over_w, trail,
            P11, P12, P21, P22, A11, A12, A21, A22, B11, B12, B21, B22,
        ) = coefficients  # fmt: skip

        # Roll: z = (φ, q) with ż = A z + (e, f), e and f linear over the step.
        e1 = -m * steer_rate
        f1 = roll_moment / M_pp - C_pd * steer_rate - K_pd * steer - C_pp * e1
        phi = P11 * phi0 + P12 * q0 + A11 * e0 + A12 * f0 + B11 * e1 + B12 * f1
        q = P21 * phi0 + P22 * q0 + A21 * e0 + A22 * f0 + B21 * e1 + B22 * f1

        phi_dot = q + e1
        q_dot = f1 - C_pp * q - K_pp * phi
        torque = steer_moment - (
            M_dp * q_dot + C_dp * phi_dot + C_dd * steer_rate + K_dp * phi + K_dd * steer
        )

        # Eq. 8; ∫v δ dt by the trapezium (exact for linear steer), ∫c δ̇ dt from the angles.
        travelled = 0.5 * h * (speed0 + speed)
        turned = cos_over_w * (
            0.5 * h * (speed0 * steer0 + speed * steer) + trail * (steer - steer0)
        )
        along = heading + 0.5 * turned
        cos, sin = _cos_sin(along)
        return BicycleState._make(
            (
                time, steer, steer_rate, speed, phi, phi_dot, q_dot,
                heading + turned, x + travelled * cos, y + travelled * sin,
                distance + travelled, self._haptics * torque, q, e1, f1,
            )
        )  # fmt: skip

    def _cached_for_array(self, h: Real, speed: Real) -> _Coefficients:
        """As long as a batch's speeds are the same object and time is one for all."""
        if not isinstance(h, float):
            return self._coefficients(h, speed)
        if speed is not self._speeds:
            self._speeds, self._of_step = speed, {}
        if h not in self._of_step:
            self._of_step[h] = self._coefficients(h, speed)
        return self._of_step[h]

    def _coefficients(self, h: float, v: Real) -> _Coefficients:
        """Eq. 4's coefficients over M_φφ, eq. 6's, and the transition over h [s] at v [m/s]."""
        g, M_pp = self.bicycle.gravity, self._M_pp
        (C_pp, C_pd), (C_dp, C_dd) = self._C1
        (K0_pp, K0_pd), (K0_dp, K0_dd) = self._K0
        (K2_pp, K2_pd), (K2_dp, K2_dd) = self._K2
        C_pp = v * C_pp / M_pp
        K_pp = (g * K0_pp + v * v * K2_pp) / M_pp
        return (
            C_pp, v * C_pd / M_pp, K_pp, (g * K0_pd + v * v * K2_pd) / M_pp,
            self._M_dp, v * C_dp, v * C_dd, g * K0_dp + v * v * K2_dp, g * K0_dd + v * v * K2_dd,
            self._m, M_pp, self._cos_over_w, self._trail,
            *transition(h, K_pp, C_pp),
        )  # fmt: skip


def _cos_sin(angle: float) -> tuple[float, float]:
    if not isinstance(angle, float):
        return np.cos(angle), np.sin(angle)
    try:
        return math.cos(angle), math.sin(angle)
    except ValueError:  # of an infinite angle; the guard must see what a broken sensor does
        return math.nan, math.nan
