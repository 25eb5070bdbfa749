"""What a virtual rider is: senses, a brain, muscles, and hands on the bar."""

from dataclasses import dataclass
from math import inf
from typing import NamedTuple, Protocol

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState
from bikesim.model.law import Law
from bikesim.model.real import Real
from bikesim.path.path import Path


class Arms(NamedTuple):
    """The rider's arms about the steer axis, felt by the bar whatever the rider does.

    `inertia` [kg m²], `damping` [N m s/rad], `stiffness` [N m/rad], between bar and trunk.
    Floats, or arrays with a value for each rig of a batch.
    """

    inertia: Real = 0.0
    damping: Real = 0.0
    stiffness: Real = 0.0


class Sight(NamedTuple):
    """What a rider knows of the bicycle, after display, eyes and balance; floats, or arrays.

    SI and radians, signs as in `BicycleState`. `station` [m] is that of the rear contact along the
    prescribed path, `deviation` [m] its distance from it (> 0: to the right of it), and
    `heading_error` [rad] the heading less that of the path there.
    """

    time: Real
    speed: Real
    roll: Real
    roll_rate: Real
    heading: Real
    station: Real
    deviation: Real
    heading_error: Real


@dataclass(frozen=True, eq=False)
class Setting:
    """Where a rider rides; he knows it before the start, as after practice.

    `inertia` I_δ [kg m²] of the rig without his arms; `speed` [m/s] at the start (an array in a
    batch of different ones); `step` [s] between two intentions: the physics step; `preview` [s]
    of riding that he sees of the path before him.
    """

    bicycle: Bicycle
    law: Law
    inertia: float
    speed: Real
    step: float
    path: Path
    preview: Real = inf


class Brain(Protocol):
    """A rider model: from what he feels and sees to the torque that he intends.

    A class of which this is an instance takes a `Setting` and, as keywords with numeric defaults,
    its figures: `__init__(self, setting, *, roll_gain=10.0)`. It is asked at every physics step.
    """

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """The intended torque [N m]: `steer` [rad], `steer_rate` [rad/s] as the hands feel them."""
        ...


class Rider(Protocol):
    """What has its hands on the bar of a virtual rig. It is asked at every physics step."""

    @property
    def arms(self) -> Arms:
        """Another object when they have changed; a rig looks at every tick."""
        ...

    def torque(self, steer: Real, steer_rate: Real, seen: BicycleState) -> Real:
        """The torque T_δ [N m] on the bar, arms not counted, for the coming physics step.

        `steer` [rad] and `steer_rate` [rad/s] are the bar's own; `seen` is the bicycle as last
        shown.
        """
        ...
