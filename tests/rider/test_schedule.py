import numpy as np

from bikesim.rider.schedule import Schedule


def test_the_value_holds_from_its_time_on():
    at = Schedule(1.0, [[(2.0, 0.0), (3.0, 5.0)]])
    times = [0.0, 1.999, 2.0, 2.5, 3.0, 100.0]
    assert [at(time) for time in times] == [1.0, 1.0, 0.0, 0.0, 5.0, 5.0]


def test_changes_that_are_past_at_the_first_look_count():
    assert Schedule(1.0, [[(2.0, 0.0), (3.0, 5.0)]])(9.0) == 5.0


def test_it_is_the_same_object_until_it_changes():
    at = Schedule(1.0, [[(2.0, 0.0)], []])
    assert at(0.0) is at(1.9)
    assert at(1.9) is not at(2.0)


def test_of_many_equal_ones_it_is_one_value():
    assert Schedule(1.0, [[(2.0, 0.0)]] * 3)(2.0) == 0.0


def test_each_of_many_has_his_own():
    at = Schedule(1.0, [[(2.0, 0.0), (4.0, 3.0)], [], [(3.0, 7.0)]])
    values = np.array([at(time) for time in (0.0, 2.0, 3.0, 4.0)])
    np.testing.assert_array_equal(values, [[1, 1, 1], [0, 1, 1], [0, 1, 7], [3, 1, 7]])
