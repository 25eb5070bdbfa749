"""What riders see in their tests."""

from collections.abc import Callable

import pytest

from bikesim import bicycles
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law

Seen = Callable[[float, float], BicycleState]


@pytest.fixture(scope="session")
def seen() -> Seen:
    """A bicycle of a roll [rad] and a roll rate [rad/s]."""
    haptic = HapticBicycle(bicycles.load("benchmark"), Law.PAPER)
    return lambda roll, roll_rate: haptic.start(roll=roll, roll_rate=roll_rate)
