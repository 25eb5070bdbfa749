import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.model.margins import critical_delay
from bikesim.model.sampled_loop import SampledLoop, with_coupling
from bikesim.report.margins_figure import margins_figure
from bikesim.report.margins_table import HEADER, MarginsTable, margins_table

LOOP = SampledLoop(0.0427, 0.001, 0.010)


@pytest.fixture(scope="module")
def table() -> MarginsTable:
    return margins_table("mine", bicycles.load("benchmark"), Law.PAPER, LOOP, [3.0, 10.0])


def data(table: MarginsTable, axes: int, line: int) -> np.ndarray:
    return np.asarray(margins_figure(table).axes[axes].lines[line].get_data())


def test_the_delay_survived_over_speed(table: MarginsTable):
    speeds, delays = data(table, 0, 0)
    assert (speeds[0], speeds[-1]) == (3.0, 10.0)
    for v, ms in ((speeds[0], delays[0]), (speeds[-1], delays[-1])):
        assert ms == pytest.approx(1e3 * critical_delay(table.bicycle, Law.PAPER, v, LOOP)[0])


def test_the_loops_own_delay_is_a_line(table: MarginsTable):
    assert data(table, 0, 1)[1, 0] == pytest.approx(10)


def test_excess_and_errors_over_speed(table: MarginsTable):
    assert data(table, 1, 0)[1].tolist() == [row.excess for row in table.rows]
    assert data(table, 1, 1)[1].tolist() == [row.error for row in table.rows]
    assert data(table, 1, 2)[1].tolist() == [row.inertia_error for row in table.rows]


def test_a_single_speed_and_a_law_without_limit_can_be_drawn():
    table = margins_table("off", bicycles.load("benchmark"), Law.OFF, LOOP, [5.0])
    assert len(margins_figure(table).axes) == 2


def test_a_row_has_a_cell_for_each_heading(table: MarginsTable):
    assert {len(row) for row in table.as_text()} == {len(HEADER)}
    assert [row[1] for row in table.as_text()] == ["yes", "NO"]


def test_what_it_is_about_names_the_coupling():
    bicycle = bicycles.load("benchmark")
    loop = with_coupling(LOOP, 0.5, bicycle, Law.PAPER)
    about = "\n".join(margins_table("mine", bicycle, Law.PAPER, loop, [5.0]).about())
    assert "0.09419 kg m² simulated" in about
    assert "delay 10 ms" in about
