import numpy as np
import pytest

from bikesim.rider.base import Sight
from bikesim.rider.roll_pd import RollPD


def sight(roll, roll_rate) -> Sight:
    return Sight(1.0, 3.5, roll, roll_rate, 0.7, 30.0, 2.0, 0.3)


def test_the_torque_is_roll_and_roll_rate_by_their_gains(setting):
    brain = RollPD(setting(), roll_gain=2.0, roll_rate_gain=0.5)
    assert brain.intend(0.0, 0.0, sight(0.1, -1.0)) == pytest.approx(2 * 0.1 - 0.5, rel=1e-15)


def test_he_does_not_feel_the_bar(setting):
    brain = RollPD(setting())
    there = sight(0.1, 0.2)
    assert brain.intend(0.0, 0.0, there) == brain.intend(0.5, -3.0, there)


def test_each_of_many_has_his_own_gains(setting):
    brain = RollPD(setting(), roll_gain=np.array([2.0, 3.0]), roll_rate_gain=0.5)
    both = brain.intend(np.zeros(2), np.zeros(2), sight(np.array([0.1, 0.2]), np.zeros(2)))
    np.testing.assert_allclose(both, [0.2, 0.6], rtol=1e-15)
