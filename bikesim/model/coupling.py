"""A virtual coupling: for a bar with less inertia than the law asks for, the rest is simulated.

The law needs a handlebar of inertia I_δ. Of a lighter one the missing part J is a handle in the
computer, hung on the bar by a spring k and a damper b, as a virtual tool is in haptics [Colgate,
Stanley & Brown 1995, "Issues in the haptic display of tool use"; Adams & Hannaford 1999]:

    J δ̈_h = T_f(δ_h, δ̇_h) - T_c,     T_c = k (δ_h - δ) + b (δ̇_h - δ̇)

The law runs on the handle's angle δ_h, and the motor gives T_c. No acceleration is measured. Below
the coupling's own frequency bar and handle move as one; above it the bar feels as light as it is.
"""

from typing import NamedTuple

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.model.real import Real
from bikesim.model.transition import transition


class Coupling(NamedTuple):
    """`inertia` J of the simulated handle [kg m²], `stiffness` k [N m/rad], `damping` b [N m s/rad]
    between it and the bar.
    """

    inertia: float
    stiffness: float
    damping: float


# Of the total delay: what leaves the coupling a phase margin at any grip, see docs/margins.md.
_PHASE = 0.3
_FASTEST = 250.0  # rad/s; above it there is nothing of a bicycle to feel, only noise


def virtual_coupling(
    share: float,
    *,
    inertia: float,
    wanted: float,
    delay: float,
    period: float,
    frequency: float | None = None,
) -> Coupling | None:
    """The coupling that adds a `share` (0 to 1) of the inertia that a bar lacks; None for none.

    `inertia` of the bar and `wanted` by the law [kg m²], `delay` from the bar's motion to torque
    and `period` of the loop [s]. `frequency` [rad/s] of the bar against the handle, critically
    damped; by default what the delay bears, at most 250 rad/s. Raises InputError for a bar that
    lacks nothing.
    """
    if share == 0.0:
        return None
    if inertia >= wanted:
        raise InputError(
            f"coupling = {share}: the bar has {inertia:.4g} kg m² and the law asks for "
            f"{wanted:.4g}: a coupling adds inertia and takes none away"
        )
    handle = share * (wanted - inertia)
    reduced = inertia * handle / (inertia + handle)
    if frequency is None:
        frequency = min(_PHASE / (delay + 0.5 * period), _FASTEST)
    return Coupling(handle, frequency**2 * reduced, 2.0 * frequency * reduced)


class CoupledBicycle(HapticBicycle):
    """A haptic bicycle on a virtual handle; see the module. Used in place of a HapticBicycle.

    Of its state `steer` and `steer_rate` are the handle's, which the roll is computed from;
    `feedback_torque` is T_c, what the motor gives. As pure as a HapticBicycle: a state is all.
    """

    def __init__(self, bicycle: Bicycle, law: Law, coupling: Coupling) -> None:
        super().__init__(bicycle, law)
        self.coupling = coupling

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
        """See `HapticBicycle`; the handle is where the bar is, and the coupling at rest."""
        state = super().start(
            time=time, steer=steer, steer_rate=steer_rate, speed=speed, roll=roll,
            roll_rate=roll_rate, heading=heading, roll_moment=roll_moment,
            steer_moment=steer_moment,
        )  # fmt: skip
        return state._replace(feedback_torque=0.0 * state.feedback_torque)

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
        """See `HapticBicycle`; steer and rate are the bar's. The handle moves exactly, for a bar
        torque k δ + b δ̇ linear between the samples and T_f held from the sample before.
        """
        inertia, stiffness, damping = self.coupling
        # What the bar put in before is in the state: the coupling's torque and the handle.
        handle, handle_rate, torque = before.steer, before.steer_rate, before.feedback_torque
        held = self._law_torque(before, steer_moment)
        old = (held + stiffness * handle + damping * handle_rate - torque) / inertia
        new = (held + stiffness * steer + damping * steer_rate) / inertia
        P11, P12, P21, P22, _, A12, _, A22, _, B12, _, B22 = transition(
            time - before.time, stiffness / inertia, damping / inertia
        )
        turned = P11 * handle + P12 * handle_rate + A12 * old + B12 * new
        turning = P21 * handle + P22 * handle_rate + A22 * old + B22 * new
        state = super().step(before, time, turned, turning, speed, roll_moment, steer_moment)
        felt = stiffness * (turned - steer) + damping * (turning - steer_rate)
        return state._replace(feedback_torque=felt)

    def _law_torque(self, state: BicycleState, steer_moment: Real) -> Real:
        """T_f of eq. 6 on the handle, from a state."""
        M, C, K = self._M_dp, self._damping_row(state.speed), self._stiffness_row(state.speed)
        return self._haptics * (
            steer_moment
            - M * state.roll_acceleration
            - C[0] * state.roll_rate
            - C[1] * state.steer_rate
            - K[0] * state.roll
            - K[1] * state.steer
        )

    def _damping_row(self, speed: Real) -> tuple[Real, Real]:
        dp, dd = self._C1[1]
        return speed * dp, speed * dd

    def _stiffness_row(self, speed: Real) -> tuple[Real, Real]:
        (dp, dd), (dp2, dd2), g = self._K0[1], self._K2[1], self.bicycle.gravity
        return g * dp + speed * speed * dp2, g * dd + speed * speed * dd2
