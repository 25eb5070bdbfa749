from itertools import repeat

import pytest

from bikesim.rider.base import Arms
from bikesim.rider.muscle import Neuromuscular
from bikesim.rider.roll_pd import RollPD


def rider(delay_steps: int, roll_gain: float = 2.0, roll_rate_gain: float = 0.5) -> RollPD:
    """Gains as given, muscles far quicker than the step."""
    return RollPD(
        roll_gain=roll_gain,
        roll_rate_gain=roll_rate_gain,
        delay_steps=delay_steps,
        muscle=Neuromuscular(1e6, 1.0, 1e-3),
        noise=repeat(0.0),
        arms=Arms(),
    )


@pytest.mark.parametrize("delay", [0, 1, 7, 400])
def test_the_delay_is_exact_in_steps(seen, delay: int):
    pd = rider(delay)
    values = [pd.torque(0.0, 0.0, seen(0.1, 0.0)) for _ in range(delay + 3)]
    assert values[:delay] == [0.0] * delay
    assert values[delay:] == pytest.approx([0.2] * 3, rel=1e-9)


def test_the_torque_is_roll_and_roll_rate_by_their_gains(seen):
    assert rider(0).torque(0.0, 0.0, seen(0.1, -1.0)) == pytest.approx(2 * 0.1 - 0.5, rel=1e-9)


def test_he_does_not_feel_the_bar_but_through_his_arms(seen):
    straight, turned = rider(0), rider(0)
    assert straight.torque(0.0, 0.0, seen(0.1, 0)) == turned.torque(0.5, -3.0, seen(0.1, 0))


def test_the_remnant_is_not_delayed_nor_filtered(seen):
    noisy = rider(100)
    noisy._noise = iter([0.3, -0.1])
    assert [noisy.torque(0.0, 0.0, seen(0.1, 0.0)) for _ in range(2)] == [0.3, -0.1]
