"""Where riders ride in their tests, and what they see."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.path.path import straight_path
from bikesim.rider.base import Rider, Setting
from bikesim.rider.building import make_rider, make_riders
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings

Seen = Callable[..., BicycleState]
MakeSetting = Callable[..., Setting]
Make = Callable[..., Rider]
MakeMany = Callable[..., Rider]
STEP = 5e-4


@pytest.fixture(scope="session")
def seen() -> Seen:
    """A bicycle of a roll [rad] and a roll rate [rad/s]; other signals by name."""
    haptic = HapticBicycle(bicycles.load("benchmark"), Law.PAPER)
    upright = haptic.start(speed=3.5)

    def of(roll: Any = 0.0, roll_rate: Any = 0.0, **signals: Any) -> BicycleState:
        return upright._replace(roll=roll, roll_rate=roll_rate, **signals)

    return of


@pytest.fixture(scope="session")
def setting() -> MakeSetting:
    """The benchmark bicycle at 3.5 m/s on a straight line; what is named otherwise."""
    usual = {
        "bicycle": bicycles.load("benchmark"),
        "law": Law.PAPER,
        "inertia": 0.23,
        "speed": 3.5,
        "step": STEP,
        "path": straight_path(),
    }
    return lambda **changed: Setting(**{**usual, **changed})


@pytest.fixture(scope="session")
def make(setting: MakeSetting) -> Make:
    """A rider by name and figures."""

    def made(
        name: str, seed: int = 1, vision: VisionSettings | None = None, **figures: Any
    ) -> Rider:
        settings, random = RiderSettings(name=name, **figures), np.random.default_rng(seed)
        return make_rider(settings, setting(), vision or VisionSettings(), random)

    return made


@pytest.fixture(scope="session")
def make_many(setting: MakeSetting) -> MakeMany:
    """The riders of a batch, each by his settings; seeds 0, 1, …"""

    def made(
        each: Sequence[RiderSettings],
        visions: Sequence[VisionSettings] | None = None,
        **changed: Any,
    ) -> Rider:
        shown = visions or [VisionSettings()] * len(each)
        randoms = [np.random.default_rng(k) for k in range(len(each))]
        return make_riders(each, setting(**changed), shown, randoms)

    return made
