"""The map over delay and arms, on few cells, and rides of single cells."""

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.report.paper.map_claims import map_claims, zero_crossings
from bikesim.report.paper.map_figure import map_figure
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.stability_map import (
    Condition,
    StabilityMap,
    check,
    over_damping,
    over_delay,
    solve_cell,
)
from bikesim.rider.base import Arms

BENCHMARK = bicycles.load("benchmark")


@pytest.fixture(scope="module")
def delays() -> StabilityMap:
    return over_delay(BENCHMARK, (0.0, 0.2, 0.4), (0.0, 5.0, 20.0), Progress(3))


@pytest.fixture(scope="module")
def dampings() -> StabilityMap:
    return over_damping(BENCHMARK, (0.0, 2.0, 4.0), (0.0, 5.0, 20.0), Progress(3))


def test_free_arms_are_unstable_with_haptics_off_at_any_delay(delays: StabilityMap):
    assert (delays.growth_rates(Law.OFF)[0] > 1).all()


def test_stiff_arms_balance_on_and_off_at_the_usual_delay(delays: StabilityMap):
    assert delays.growth_rates(Law.PAPER)[2, 1] < 0
    assert delays.growth_rates(Law.OFF)[2, 1] < 0


def test_late_eyes_need_haptics_whatever_the_arms(delays: StabilityMap):
    assert (delays.growth_rates(Law.PAPER)[:, 2] < 0).all()
    assert (delays.growth_rates(Law.OFF)[:, 2] > 0).all()


def test_both_maps_agree_where_they_meet(delays: StabilityMap, dampings: StabilityMap):
    """At 0.2 s: 20 N m/rad with 4 N m s/rad is a cell of both."""
    for law in (Law.PAPER, Law.OFF):
        one, other = delays.growth_rates(law)[2, 1], dampings.growth_rates(law)[2, 2]
        assert one == pytest.approx(other, abs=0.003)


def test_damping_is_in_proportion_to_stiffness(delays: StabilityMap):
    assert delays.cells[2][0].condition.arms == Arms(0.1, 4.0, 20.0)


def test_zero_crossings_are_between_the_rows_where_the_sign_changes(delays: StabilityMap):
    first, second, last = zero_crossings(delays, Law.OFF)
    assert first is not None
    assert second is not None
    assert 0 < first < 5 < second < 20
    assert last is None


@pytest.mark.parametrize("law", [Law.PAPER, Law.OFF])
def test_a_ride_in_the_virtual_rig_does_what_the_map_says(law: Law):
    cell = solve_cell(BENCHMARK, Condition(0.2, Arms(0.1, 2.0, 5.0)))
    checked = check(cell, law, duration=20.0)
    assert checked is not None
    assert checked.roll.grew is (law is Law.OFF)
    assert checked.agrees


def test_a_marginal_cell_is_not_ridden():
    cell = solve_cell(BENCHMARK, Condition(0.4, Arms(0.1, 6.0, 30.0)))
    assert check(cell, Law.PAPER, duration=20.0) is None


def test_the_paper_s_conclusion_is_no_law_of_nature(delays: StabilityMap):
    proof, soft, law_of_nature, _ = map_claims(BENCHMARK, delays, [])
    assert proof.holds
    assert soft.holds
    assert not law_of_nature.holds
    assert law_of_nature.ours == "so in 5 of 9 cells of the map"


def test_the_figure_shows_both_maps(delays: StabilityMap, dampings: StabilityMap):
    drawn = map_figure(delays, dampings, [])
    names = [axes.get_title(loc="left") for axes in drawn.axes if axes.get_title(loc="left")]
    assert len(names) == 6


def test_a_map_is_the_same_every_time():
    one, other = (
        over_delay(BENCHMARK, (0.1, 0.2), (5.0,), Progress(1)).growth_rates(Law.OFF)
        for _ in range(2)
    )
    np.testing.assert_array_equal(one, other)
