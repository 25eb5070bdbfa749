"""A virtual rig to push: hands off, or with arms."""

from collections.abc import Callable

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.rider.base import Arms, Rider
from bikesim.rig.settings import RigSettings
from bikesim.rig.virtual import VirtualRig

INERTIA = 0.25
MakeRig = Callable[..., VirtualRig]


@pytest.fixture(scope="session")
def upright() -> BicycleState:
    """The bicycle to show where it does not matter."""
    return HapticBicycle(bicycles.load("benchmark"), Law.PAPER).start()


class OnlyArms:
    """Arms that lie on the bar and do nothing."""

    def __init__(self, arms: Arms) -> None:
        self.arms = arms

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        return 0.0


class Pull:
    """A rider who pulls with one torque and notes what he feels and sees."""

    arms = Arms()

    def __init__(self, torque: float) -> None:
        self.asked: list[tuple[float, float, BicycleState]] = []
        self._torque = torque

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        self.asked.append((steer, steer_rate, seen))
        return self._torque


@pytest.fixture
def make_rig(upright: BicycleState) -> MakeRig:
    """`make_rig(arms=, rider=, period=, step=, inertia=, seed=, **settings)`."""

    def make(
        arms: Arms | None = None,
        rider: Rider | None = None,
        period: float = 1e-3,
        step: float = 5e-4,
        inertia: float = INERTIA,
        seed: int = 1,
        **settings,
    ) -> VirtualRig:
        rig = VirtualRig(
            RigSettings(**settings),
            rider or OnlyArms(arms or Arms()),
            name="a rig",
            inertia=inertia,
            steer_axis_tilt=0.3,
            period=period,
            step=step,
            random=np.random.default_rng(seed),
        )
        rig.show(upright)
        return rig

    return make


def turn(rig: VirtualRig, rate: float = 0.0, angle: float = 0.0) -> None:
    """Set the bar going: rate [rad/s] and angle [rad], before the first wait."""
    rig.data.qvel[0], rig.data.qpos[0] = rate, angle


def wait(rig: VirtualRig, ticks: int) -> None:
    for _ in range(ticks):
        rig.wait()


def true_steer(rig: VirtualRig) -> float:
    return rig.telemetry()[2]


def true_rate(rig: VirtualRig) -> float:
    return rig.telemetry()[3]
