"""What every rider does, whatever his name."""

import math

import numpy as np
import pytest

from bikesim.model.haptic import BicycleState
from bikesim.rider.base import Rider
from bikesim.rider.building import make_rider
from bikesim.rider.settings import RiderSettings, rider_names

STEP = 5e-4
riders = pytest.mark.parametrize("name", rider_names())


def made(name: str, seed: int = 1, **figures: float) -> Rider:
    settings = RiderSettings(name=name, **figures)
    return make_rider(settings, STEP, np.random.default_rng(seed))


def torques(rider: Rider, seen) -> list[float]:
    """Of a second on a bicycle that sways."""
    return [
        rider.torque(
            0.1 * math.sin(0.01 * k), math.cos(0.01 * k), seen(0.1 * math.sin(0.003 * k), 0.3)
        )
        for k in range(2000)
    ]


@riders
def test_his_torque_is_a_finite_float(name: str, seen):
    values = torques(made(name), seen)
    assert all(type(value) is float and math.isfinite(value) for value in values)


@riders
def test_his_arms_are_not_negative(name: str):
    assert all(figure >= 0 for figure in made(name).arms)


@riders
def test_the_same_seed_gives_the_same_torques(name: str, seen):
    assert torques(made(name, seed=5), seen) == torques(made(name, seed=5), seen)


@pytest.mark.parametrize("name", [name for name in rider_names() if name != "hands-off"])
def test_another_seed_gives_another_remnant(name: str, seen):
    first, second = (torques(made(name, seed, remnant_rms=0.1), seen) for seed in (1, 2))
    assert first != second


@pytest.mark.parametrize("name", [name for name in rider_names() if name != "hands-off"])
def test_two_of_a_kind_keep_their_own_state(name: str, seen):
    alone = torques(made(name), seen)
    first, second = made(name), made(name, 2)
    torques(second, seen)
    assert torques(first, seen) == alone


@pytest.mark.parametrize("name", [name for name in rider_names() if name != "hands-off"])
def test_he_steers_into_the_fall(name: str, seen):
    rider, falling_right = made(name, remnant_rms=0.0), seen(0.1, 0.1)
    values: list[BicycleState | float] = [
        rider.torque(0.0, 0.0, falling_right) for _ in range(2000)
    ]
    assert values[-1] > 0  # pyright: ignore[reportOperatorIssue]


def test_hands_off_there_is_no_torque(seen):
    assert set(torques(made("hands-off"), seen)) == {0.0}
    assert made("hands-off").arms == (0, 0, 0)
