import pytest

from bikesim.report.experiment.comparisons import MOST, Asked, Named, comparisons
from bikesim.report.experiment.data import Comparison, Condition, Data, Factor


def test_unasked_each_level_against_the_first_all_else_equal(data: Data):
    """6 of the law, 6 of the roll cue, 2 speeds x 4 of the others."""
    names = [one.name for one in data.comparisons]
    assert len(names) == 6 + 6 + 8
    assert names[0] == "law off against paper, where roll cue on, speed 2.5 m/s"
    assert names[6] == "roll cue off against on, where law paper, speed 2.5 m/s"
    assert names[-1] == "speed 7 against 2.5 m/s, where law off, roll cue off"


def test_the_second_is_what_is_named_first(data: Data):
    first = data.comparisons[0]
    assert first.first == "law=paper, roll cue=on, speed=2.5"
    assert first.second == "law=off, roll cue=on, speed=2.5"


def test_what_is_asked_is_all_that_is_made(data: Data):
    made = comparisons([Asked("speed", 7.0, 5.0)], data.factors, data.conditions)
    assert made[0].name == "speed 5 against 7 m/s, where law paper, roll cue on"
    assert len(made) == 4


def test_no_more_than_the_most_unasked():
    """Of the first factor's as many as there may be; another's only if they all fit."""
    many, few = Factor("a", "a", "", tuple(range(30))), Factor("b", "b", "", tuple(range(3)))
    grid = [Condition(f"{i} {j}", (i, j)) for i in range(30) for j in range(3)]
    turned = [Condition(one.name, one.levels[::-1]) for one in grid]
    made = comparisons((), (many, few), grid)
    assert (len(made), made[0].name, MOST) == (40, "a 1 against 0, where b 0", 40)
    assert len(comparisons((), (few, many), turned)) == 40 < 2 * 30
    short = [one for one in turned if one.levels[1] < 10]
    less = Factor("a", "a", "", tuple(range(10)))
    made = comparisons((), (few, less), short)
    assert (len(made), {one.name[0] for one in made}) == (2 * 10, {"b"})  # 27 more do not fit


def test_a_condition_that_is_not_there_is_not_compared(data: Data):
    made = comparisons((), data.factors, data.conditions[1:])
    assert all(one.first != data.conditions[0].name for one in made)
    assert len(made) == 20 - 4


@pytest.mark.parametrize("level", [None, "momentum"])
def test_an_extra_condition_is_compared_with_none(data: Data, level):
    extra = Condition("extra", (level, True, 2.5))
    made = comparisons((), data.factors, (*data.conditions, extra))
    assert made == data.comparisons


def test_a_condition_beside_the_grid_takes_no_cell_of_it(data: Data):
    """One that sets other keys has the levels of a cell all the same."""
    extra = Condition("a hard start", data.conditions[0].levels, beside=True)
    made = comparisons((), data.factors, (*data.conditions, extra))
    assert made == data.comparisons


def test_a_condition_beside_the_grid_is_compared_by_its_name(data: Data):
    extra = Condition("nobody", (None, True, 2.5), beside=True)
    cell = data.conditions[0].name
    made = comparisons([Named("nobody", cell)], data.factors, (*data.conditions, extra))
    assert made == (Comparison(f"nobody against {cell}", first=cell, second="nobody"),)


def test_a_condition_that_has_no_run_yet_is_not_compared(data: Data):
    asked = [Named("nobody", data.conditions[0].name)]
    assert comparisons(asked, data.factors, data.conditions) == ()


def test_what_is_asked_twice_is_made_once(data: Data):
    first, second = data.comparisons[0].first, data.comparisons[0].second
    asked = [Asked("law", "paper", "off"), Named(second, first), Named(second, first)]
    assert comparisons(asked, data.factors, data.conditions) == data.comparisons[:6]
    turned = [*asked, Named(first, second), Asked("law", "off", "paper")]
    assert comparisons(turned, data.factors, data.conditions) == data.comparisons[:6]
