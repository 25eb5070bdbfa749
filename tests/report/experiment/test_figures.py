import dataclasses

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes

from bikesim.report.experiment.data import Condition, Data, Factor
from bikesim.report.experiment.figures import (
    contrasts_figure,
    falls_figure,
    metric_figure,
    odds_figure,
)
from bikesim.report.experiment.findings import find
from bikesim.report.experiment.layout import arrange
from bikesim.report.experiment.survival_figure import survival_figure


def points(axes: Axes) -> list[tuple[list[float], list[float]]]:
    """x and y of each line that joins points."""
    found = []
    for line in axes.get_lines():
        if line.get_linestyle() == "-":
            x, y = line.get_data()
            found.append((np.asarray(x, float).tolist(), np.asarray(y, float).tolist()))
    return found


def test_falls_over_speed_a_panel_for_each_roll_cue(data: Data):
    drawn = falls_figure(find(data), arrange(data.factors, data.conditions))
    assert [axes.get_title("left") for axes in drawn.axes] == ["roll cue on", "roll cue off"]
    (paper_x, paper), (_, off) = points(drawn.axes[0])
    assert paper == [0, 0, 0]
    assert off == [100, 0, 0]
    assert paper_x == pytest.approx([2.5, 5, 7], abs=0.3)
    assert drawn.axes[0].get_xlabel() == "speed [m/s]"
    assert drawn.axes[0].get_ylabel() == "fell [%]"
    assert [text.get_text() for text in drawn.legends[0].get_texts()] == ["law paper", "law off"]


def test_a_metric_in_the_unit_that_a_person_reads(data: Data):
    findings = find(data)
    drawn = metric_figure(findings, arrange(data.factors, data.conditions), "roll_rms")
    assert drawn.axes[0].get_ylabel() == "roll rms [deg]"
    _, middle = points(drawn.axes[0])[0]
    expected = [np.degrees(findings.conditions[i].metrics[1].median) for i in range(3)]
    assert middle == pytest.approx(expected)


def test_survival_a_panel_for_each_cell(data: Data):
    findings = find(data)
    drawn = survival_figure(findings, arrange(data.factors, data.conditions))
    titles = [axes.get_title("left") for axes in drawn.axes if axes.get_visible()]
    assert titles[:2] == ["roll cue on\nspeed 2.5 m/s", "roll cue on\nspeed 5 m/s"]
    assert len(titles) == 6
    steps = drawn.axes[0].get_lines()[1]
    assert float(np.min(np.asarray(steps.get_ydata(), float))) == 0


def test_survival_of_many_cells_a_panel_for_all_places(data: Data):
    """Twenty speeds: too many panels to see anything."""
    speeds = Factor("speed", "speed", "m/s", tuple(np.linspace(2, 8, 20).tolist()))
    made = tuple(Condition(f"{v:g}", (v,)) for v in speeds.levels)
    rows = data.table[data.table["condition"] == data.conditions[6].name]
    table = [rows.assign(condition=one.name, speed=one.levels[0]) for one in made]
    many = dataclasses.replace(
        data, factors=(speeds,), conditions=made, table=pd.concat(table), comparisons=()
    )
    drawn = survival_figure(find(many), arrange(many.factors, made))
    assert len(drawn.axes) == 1
    assert len(drawn.axes[0].get_lines()) == 20


def test_contrasts_of_falls_and_of_a_metric(data: Data):
    contrasts = find(data).contrasts
    drawn = contrasts_figure(contrasts)
    names = [label.get_text() for label in drawn.axes[0].get_yticklabels()]
    assert names == [one.name for one in data.comparisons]
    assert drawn.axes[0].get_xlabel() == "difference in falls [percentage points]"
    effect = contrasts_figure(contrasts, "roll_rms")
    assert effect.axes[0].get_xlabel() == "roll rms: effect $d_z$"


def test_odds_without_the_constant_on_a_logarithmic_axis(data: Data):
    model = find(data).regression.model
    assert model is not None
    axes = odds_figure(model.terms).axes[0]
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["law off", "roll cue off", "speed 5 m/s", "speed 7 m/s"]
    assert axes.get_xscale() == "log"


def test_a_condition_that_lacks_its_runs_is_left_out(data: Data):
    """Half done: one panel has no haptics off yet."""
    there = tuple(one for one in data.conditions if one.levels[:2] != ("off", False))
    names = {one.name for one in there}
    half = dataclasses.replace(
        data,
        conditions=there,
        table=data.table[data.table["condition"].isin(sorted(names))],
        comparisons=(),
    )
    drawn = falls_figure(find(half), arrange(half.factors, there))
    assert [len(points(axes)) for axes in drawn.axes] == [2, 1]
