"""The identified riders in the virtual rig, for one of them, and their figure."""

from pathlib import Path

import pytest

from bikesim.report.paper.identified import IdentifiedRide, identified_claims, ride_identified
from bikesim.report.paper.identified_figure import identified_figure
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.riding import fell
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS


@pytest.fixture(scope="module")
def rides(tmp_path_factory: pytest.TempPathFactory) -> list[IdentifiedRide]:
    run = next(run for run in IDENTIFIED_RUNS if run.run == 184)
    records: Path = tmp_path_factory.mktemp("records")
    return ride_identified(records, 4.0, Progress(2), [run])


def test_growth_rates_are_those_of_the_linear_analysis(rides: list[IdentifiedRide]):
    growth = rides[0].growth  # SCIENCE.md section 3
    assert growth.bicycle == pytest.approx(-0.781, abs=6e-4)
    assert growth.on == pytest.approx(-0.746, abs=6e-4)
    assert growth.off == pytest.approx(3.830, abs=6e-4)


def test_the_rider_stays_up_with_haptics_only(rides: list[IdentifiedRide]):
    assert not fell(rides[0].on)
    assert fell(rides[0].off)


def test_the_claims_count_riders(rides: list[IdentifiedRide]):
    claims = identified_claims(rides)
    assert [claim.holds for claim in claims] == [True] * 4
    assert claims[2].ours == "1 of 1"


def test_records_are_kept_by_run_and_haptics(rides: list[IdentifiedRide]):
    assert rides[0].on.path.name == "schwab2013-184-on.h5"
    assert rides[0].off.path.name == "schwab2013-184-off.h5"


def test_the_figure_has_a_plot_for_each_rider(rides: list[IdentifiedRide]):
    visible = [axes for axes in identified_figure(rides).axes if axes.get_visible()]
    assert len(visible) == 2
