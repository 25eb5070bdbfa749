"""What reaches the brain: told by a brain that notes what it sees."""

import math
from itertools import repeat

import numpy as np
import pytest

from bikesim.model.haptic import Real
from bikesim.path.building import make_path
from bikesim.path.path import Path, straight_path
from bikesim.path.settings import PathSettings
from bikesim.rider.base import Sight
from bikesim.rider.delay import delay_line
from bikesim.rider.schedule import Schedule
from bikesim.rider.senses import Balance, Display, Eyes, Felt, Hands, Turned

BEFORE = Sight(0.0, 3.5, *(0.0,) * 6)


def display(
    path: Path | None = None, roll_cue: Real = 1.0, light: Schedule | None = None
) -> Display:
    return Display(path or straight_path(), BEFORE, roll_cue, light)


def test_on_the_straight_line_the_place_is_where_the_bicycle_is(seen):
    bicycle = seen(0.1, 0.2, time=4.0, heading=0.3, x=20.0, y=-1.5)
    assert display()(bicycle) == Sight(4.0, 3.5, 0.1, 0.2, 0.3, 20.0, -1.5, 0.3)


def test_beside_a_circle_the_place_is_along_it(seen):
    """Half-way round to the right, a metre outside, heading 0.1 rad further to the right."""
    path = make_path(PathSettings(kind="circle", start=0.0, radius=20.0, entry=0.5))
    eyes = display(path)
    sight = BEFORE
    for station in np.arange(0.0, 60.0, 1.0).tolist():
        x, y = path.point(station)
        along = path.heading(station)
        # Outside is to the left. A whole turn more of heading is the same heading.
        out = x + math.sin(along), y - math.cos(along)
        sight = eyes(seen(x=out[0], y=out[1], heading=along + 0.1 + 2 * math.pi))
    assert sight.station == pytest.approx(59.0, abs=1e-3)
    assert sight.deviation == pytest.approx(-1.0, abs=1e-3)
    assert sight.heading_error == pytest.approx(0.1, abs=1e-3)
    assert sight.heading == pytest.approx(path.heading(59.0) + 0.1 + 2 * math.pi)


def test_without_the_roll_cue_the_horizon_is_level(seen):
    sight = display(roll_cue=0.0)(seen(0.1, 0.2, heading=0.3, y=1.0))
    assert (sight.roll, sight.roll_rate) == (0.0, 0.0)
    assert (sight.heading, sight.deviation) == (0.3, 1.0)


def test_each_of_many_has_the_cue_or_not(seen):
    roll = np.array([0.1, 0.1])
    sight = display(roll_cue=np.array([0.0, 1.0]))(seen(roll, 2 * roll))
    assert sight.roll.tolist() == [0.0, 0.1]
    assert sight.roll_rate.tolist() == [0.0, 0.2]


def test_in_the_dark_he_has_what_he_saw_last(seen):
    eyes = display(light=Schedule(1.0, [[(1.0, 0.0), (2.0, 1.0)]]))
    rolls = [eyes(seen(time, 0.0, time=time)).roll for time in (0.5, 0.9, 1.0, 1.5, 1.9, 2.0, 2.1)]
    assert rolls == [0.5, 0.9, 0.9, 0.9, 0.9, 2.0, 2.1]


def test_in_the_dark_from_the_start_on_he_has_what_was_before(seen):
    eyes = display(light=Schedule(1.0, [[(0.0, 0.0), (2.0, 1.0)]]))
    assert eyes(seen(0.3, 0.0, time=0.0)) == BEFORE


def test_each_of_many_has_his_own_dark(seen):
    eyes = display(light=Schedule(1.0, [[(1.0, 0.0)], [], [(2.0, 0.0)]]))
    rolls = [
        eyes(seen(np.full(3, time), np.zeros(3), time=time)).roll.tolist()
        for time in (0.5, 1.0, 2.0, 3.0)
    ]
    assert rolls == [[0.5, 0.5, 0.5], [0.5, 1.0, 1.0], [0.5, 2.0, 1.0], [0.5, 3.0, 1.0]]


def test_noise_is_added_to_what_it_is_named_after():
    eyes = Eyes(repeat(1.0), repeat(2.0), repeat(3.0), repeat(4.0))
    assert eyes(Sight(*(0.0,) * 8)) == Sight(0, 0, 1, 2, 3, 0, 4, 3)
    assert Hands(None, repeat(5.0))(Felt(1.0, 1.0)) == Felt(1.0, 6.0)


def test_the_balance_organs_feel_what_the_display_does_not_show(seen):
    organs = Balance(0.25, None, None)
    sight = organs(BEFORE._replace(roll_rate=2.0), seen(0.1, 10.0))
    assert sight == BEFORE._replace(roll_rate=0.75 * 2.0 + 0.25 * 10.0)


def test_the_balance_organs_have_a_delay_and_a_noise_of_their_own(seen):
    organs = Balance(1.0, repeat(0.5), delay_line(2e-3, 1e-3, Turned(0.0)))
    rates = [organs(BEFORE, seen(0.0, float(k))).roll_rate for k in range(5)]
    assert rates == [0.0, 0.0, 0.5, 1.5, 2.5]
