"""What a virtual rider is: eyes on the bicycle, hands on the bar, arms of a stiffness."""

from typing import NamedTuple, Protocol

from bikesim.model.haptic import BicycleState


class Arms(NamedTuple):
    """The rider's arms about the steer axis, felt by the bar whatever the rider does.

    `inertia` [kg m²], `damping` [N m s/rad], `stiffness` [N m/rad], between bar and trunk.
    """

    inertia: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0


class Rider(Protocol):
    """A rider model. It is asked at every physics step, which it was made for."""

    @property
    def arms(self) -> Arms: ...

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        """The torque T_δ [N m] on the bar, arms not counted, for the coming physics step.

        `steer` [rad] and `steer_rate` [rad/s] are the bar's own, as the hands feel them; `seen`
        is the bicycle as last shown.
        """
        ...
