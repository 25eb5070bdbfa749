import dataclasses
import io
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes

from bikesim.report.experiment.data import Condition, Data, Factor
from bikesim.report.experiment.figures import (
    MOST_ROWS,
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
    assert drawn.axes[0].get_ylabel() == "roll RMS [deg]"
    _, middle = points(drawn.axes[0])[0]
    expected = [np.degrees(findings.conditions[i].metrics[1].median) for i in range(3)]
    assert middle == pytest.approx(expected)


def with_values(data: Data, name: str, values: np.ndarray) -> Data:
    return dataclasses.replace(data, table=data.table.assign(**{name: values}), metrics=(name,))


def test_small_values_beside_large_ones_are_seen(data: Data):
    """A decade or more between them: on a logarithmic axis, unless some are not above 0."""
    layout = arrange(data.factors, data.conditions)
    values = 0.1 * data.table["speed"].to_numpy() ** 3
    for changed, scale in ((values, "log"), (values - 2, "linear"), (values**0.5, "linear")):
        changed_data = with_values(data, "steer_rms", changed)
        drawn = metric_figure(find(changed_data), layout, "steer_rms")
        assert [axes.get_yscale() for axes in drawn.axes] == [scale, scale]


def test_a_panel_without_a_value_says_so(data: Data):
    layout = arrange(data.factors, data.conditions)
    lit = data.table["vision.roll_cue"].to_numpy(bool)
    changed_data = with_values(data, "steer_rms", np.where(lit, np.nan, 1.0))
    drawn = metric_figure(find(changed_data), layout, "steer_rms")
    assert [[text.get_text() for text in axes.texts] for axes in drawn.axes] == [["none"], []]


def test_titles_of_panels_do_not_reach_the_next_one(data: Data):
    long = tuple(one._replace(levels=(*one.levels[:2], None)) for one in data.conditions)
    drawn = survival_figure(find(data), arrange(data.factors, long))
    drawn.draw_without_rendering()
    visible = [axes for axes in drawn.axes if axes.get_visible()]
    assert len(visible) == len(long)
    for left, right in pairwise(visible):
        box, after = left._left_title.get_window_extent(), right.get_window_extent()  # type: ignore[attr-defined]
        assert box.x1 < after.x0 or after.x0 < box.x0  # or the next row


def test_every_condition_has_its_place_on_the_axis(data: Data):
    """Also at the ends, where nobody has the metric."""
    law = (Factor("law", "law", "", ("paper", "off", "momentum")),)
    made = tuple(Condition(level, (level,)) for level in law[0].levels)
    rows = data.table[data.table["condition"] == data.conditions[0].name]
    table = pd.concat([rows.assign(condition=one.name, law=one.name) for one in made])
    table.loc[table["law"] != "off", "roll_rms"] = np.nan
    three = dataclasses.replace(data, factors=law, conditions=made, table=table, comparisons=())
    drawn = metric_figure(find(three), arrange(law, made), "roll_rms")
    low, high = drawn.axes[0].get_xlim()
    assert low < 0
    assert high > 2


def test_an_interval_of_the_fall_time_without_an_end_ends_with_the_longest_ride(data: Data):
    table = data.table.copy()
    late = (table["condition"] == data.conditions[6].name) & (table["seed"] > 6)
    table.loc[late, ["fell", "fall_time", "duration", "ending"]] = [0, np.nan, 20, "end of run"]
    findings = find(dataclasses.replace(data, table=table))
    assert findings.conditions[6].metrics[0].high == np.inf
    drawn = metric_figure(findings, arrange(data.factors, data.conditions), "fall_time")
    paths = [path for drawn_one in drawn.axes[0].collections for path in drawn_one.get_paths()]
    ends = [np.asarray(path.vertices, float)[:, 1].max() for path in paths]
    assert np.nanmax(ends) == 20


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
    assert effect.axes[0].get_xlabel() == "roll RMS: effect $d_z$"


def test_of_very_many_contrasts_the_first_are_drawn(data: Data):
    """All of two thousand would be too tall to be painted."""
    many = 100 * find(data).contrasts
    drawn = contrasts_figure(many)
    assert len(drawn.axes[0].get_yticklabels()) == MOST_ROWS
    assert drawn.axes[0].get_title("left") == f"the first {MOST_ROWS} of 2000"
    drawn.savefig(io.BytesIO(), format="png")
    assert contrasts_figure(many[:MOST_ROWS]).axes[0].get_title("left") == ""


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
