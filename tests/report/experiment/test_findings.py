import dataclasses
import math

import numpy as np
import pandas as pd
import pytest
import statsmodels.api as sm
from scipy import stats
from statsmodels.stats.multitest import multipletests

from bikesim.report.experiment.comparisons import Asked, Named, comparisons
from bikesim.report.experiment.data import Condition, Data, Factor
from bikesim.report.experiment.findings import find


def test_a_condition(data: Data):
    found = find(data)
    fallen, up = found.conditions[6], found.conditions[0]
    assert fallen.condition.levels == ("off", True, 2.5)
    assert (fallen.falls.events, fallen.falls.runs) == (12, 12)
    assert fallen.survival.median == pytest.approx(2.6)
    assert (up.falls.events, math.isnan(up.survival.median)) == (0, True)


def test_metrics_are_of_the_runs_that_stayed_up(data: Data):
    fallen = find(data).conditions[6]
    fall_time, roll, _ = fallen.metrics
    assert (fall_time.runs, fall_time.median) == (12, pytest.approx(2.6))
    assert (roll.runs, math.isnan(roll.median)) == (0, True)


def test_a_median_of_falls_counts_those_who_did_not_fall(data: Data):
    """Five of twelve fell, the last at 2.5 s: of the fallen the median is 2.3 s, of all none."""
    table = data.table.copy()
    late = (table["condition"] == data.conditions[6].name) & (table["seed"] > 5)
    table.loc[late, ["fell", "fall_time", "duration", "ending"]] = [0, math.nan, 20, "end of run"]
    fall_time = find(dataclasses.replace(data, table=table)).conditions[6].metrics[0]
    assert (fall_time.runs, math.isnan(fall_time.median)) == (12, True)
    assert fall_time.lower_quartile == pytest.approx(2.3)


def test_a_fall_is_when_it_was_not_when_the_ride_was_over(data: Data):
    """A ride lasts until the end of the tick of its fall, here 10 ms on."""
    table = data.table.assign(duration=data.table["duration"] + 0.01)
    found = find(dataclasses.replace(data, table=table)).conditions
    assert found[6].survival.time == pytest.approx(2.0 + 0.1 * np.arange(1, 13))
    assert found[6].metrics[0].median == pytest.approx(2.6)
    assert found[0].survival.last == 20.01


def test_the_interval_of_a_median_is_between_the_third_and_the_tenth_of_twelve(data: Data):
    """Tables of the sign test: with 12 values the 3rd and 10th hold it in 96.1 % of cases."""
    values = np.sort(data.values(data.conditions[0].name, "roll_rms"))
    roll = find(data).conditions[0].metrics[1]
    assert (roll.low, roll.high) == (values[2], values[9])
    assert roll.median == pytest.approx(np.median(values))


def test_a_fault_is_no_fall_and_has_no_metrics(data: Data):
    table = data.table.copy()
    table.loc[0, "ending"] = "fault: feedback torque is nan"
    found = find(dataclasses.replace(data, table=table)).conditions[0]
    assert (found.faults, found.falls.events, found.metrics[1].runs) == (1, 0, 11)


def test_contrasts_pair_the_seeds(data: Data):
    found = find(data)
    law, cue = found.contrasts[0], found.contrasts[6]
    assert (law.falls.first, law.falls.second, law.falls.difference) == (0, 12, 1.0)
    assert law.metrics[0].difference.pairs == 0
    first, second = (data.values(name, "roll_rms") for name in cue.comparison[1:])
    roll = cue.metrics[0]
    assert roll.metric == "roll_rms"
    assert roll.difference.p_wilcoxon == pytest.approx(stats.wilcoxon(second, first).pvalue)
    assert roll.difference.mean == pytest.approx(float(np.mean(second - first)))


def test_pairs_go_by_seed_not_by_row(data: Data):
    shuffled = data.table.sample(frac=1.0, random_state=1)
    again = find(dataclasses.replace(data, table=shuffled))
    assert again.contrasts[6] == find(data).contrasts[6]


def test_a_seed_that_one_condition_lacks_is_no_pair(data: Data):
    found = find(dataclasses.replace(data, table=data.table.iloc[1:]))
    assert sum(found.contrasts[0].falls[:4]) == 11


def test_seeds_beyond_the_whole_numbers_that_floats_have_are_paired_too(data: Data):
    """As of a clock in nanoseconds, one by one: above 2^60 only each 256th is a float."""
    table = data.table.assign(seed=1_750_000_000_000_000_000 + data.table["seed"])
    assert len(set(table["seed"].astype(float))) < len(set(table["seed"]))
    for shown in (table, table.sample(frac=1.0, random_state=1)):
        assert find(dataclasses.replace(data, table=shown)).contrasts == find(data).contrasts
    lacking = dataclasses.replace(data, table=table.drop(index=[0, 13]))
    without = dataclasses.replace(data, table=data.table.drop(index=[0, 13]))
    assert repr(find(lacking).contrasts) == repr(find(without).contrasts)


def test_p_is_corrected_for_all_tests_that_were_made(data: Data):
    found = find(data)
    made = [one.falls.p for one in found.contrasts]
    made += [m.difference.p_wilcoxon for one in found.contrasts for m in one.metrics]
    assert found.tests == sum(not math.isnan(p) for p in made)
    smallest = min(p for p in made if not math.isnan(p))
    corrected = min(one.falls_p_holm for one in found.contrasts)
    assert corrected == pytest.approx(min(1.0, found.tests * smallest))


def test_the_regression_says_that_falls_are_separated(data: Data):
    found = find(data).regression
    assert found.model is not None
    assert found.model.separated
    assert [term.name for term in found.model.terms] == [
        "constant", "law off", "roll cue off", "speed 5 m/s", "speed 7 m/s",
    ]  # fmt: skip
    by_name = {term.name: term for term in found.model.terms}
    assert by_name["law off"].low > 0
    assert by_name["roll cue off"].low < 0 < by_name["roll cue off"].high
    assert found.reference == (("law", "paper"), ("roll cue", "on"), ("speed", "2.5 m/s"))


def test_the_p_of_the_regression_are_corrected_for_its_terms(data: Data):
    model = find(data).regression.model
    assert model is not None
    constant, *terms = model.terms
    assert math.isnan(constant.p_holm)
    expected = np.asarray(multipletests([term.p for term in terms], method="holm")[1])
    assert [term.p_holm for term in terms] == pytest.approx(expected)


def test_a_contrast_by_name_is_paired_and_counted(data: Data):
    """A condition beside the grid in which roll is half as large again."""
    cell = data.conditions[0]
    rows = data.table[data.table["condition"] == cell.name]
    rows = rows.assign(condition="beside", roll_rms=1.5 * rows["roll_rms"])
    conditions = (*data.conditions, Condition("beside", cell.levels, beside=True))
    asked = [Asked("law", "paper", "off"), Named("beside", cell.name)]
    found = find(
        dataclasses.replace(
            data,
            table=pd.concat([data.table, rows.sample(frac=1.0, random_state=1)]),
            conditions=conditions,
            comparisons=comparisons(asked, data.factors, conditions),
        )
    )
    named, grid = found.contrasts[-1], found.contrasts[:-1]
    assert named.comparison == (f"beside against {cell.name}", cell.name, "beside")
    assert named.metrics[0].difference.pairs == 12
    roll = data.values(cell.name, "roll_rms").mean()
    assert named.metrics[0].difference.mean == pytest.approx(0.5 * roll)
    tests = sum(not math.isnan(m.difference.p_wilcoxon) for one in grid for m in one.metrics)
    assert found.tests == len(grid) + tests + 1 + len(named.metrics)


def ten_periods(data: Data, unit: float) -> Data:
    """Falls by the loop period, 1 to 10 ms in a `unit` of so many a second, and by the law."""
    random = np.random.default_rng(1)
    periods = tuple((unit * np.arange(1, 11) * 1e-3).round(9).tolist())
    factors = (Factor("period", "loop period", "s", periods), data.factors[0])
    conditions = tuple(Condition(f"{p} {w}", (p, w)) for p in periods for w in ("paper", "off"))
    rows = pd.concat([data.table.iloc[:60]] * len(conditions), ignore_index=True)
    each = np.repeat(np.arange(len(conditions)), 60)
    odds = 1000 * (np.repeat(np.arange(1, 11), 120) * 1e-3 - 0.0055) + (each % 2)
    table = rows.assign(
        condition=[conditions[i].name for i in each],
        period=[conditions[i].levels[0] for i in each],
        law=[conditions[i].levels[1] for i in each],
        seed=np.tile(np.arange(60), len(conditions)),
        fell=(random.random(len(each)) < 1 / (1 + np.exp(-odds))).astype(float),
    )
    return dataclasses.replace(
        data, factors=factors, conditions=conditions, table=table, comparisons=()
    )


def test_of_a_number_with_many_levels_there_is_a_slope_over_its_range(data: Data):
    """The same in all units, and that of statsmodels; the slope is against no level."""
    made = ten_periods(data, 1.0)
    found = find(made).regression
    assert found.model is not None
    slope, law = found.model.terms[1:]
    assert slope.name == "loop period, from 0.001 to 0.01 s"
    assert found.reference == (("law", "paper"),)
    milliseconds = 1000 * made.table["period"].to_numpy(float)
    design = np.column_stack([np.ones(1200), milliseconds, made.table["law"] == "off"])
    other = sm.Logit(made.table["fell"].to_numpy(), design.astype(float)).fit(disp=0)
    assert [slope.estimate / 9, law.estimate] == pytest.approx(other.params[1:], rel=1e-6)
    assert slope.low < slope.estimate < slope.high < math.inf
    for unit in (1e3, 1e-6):
        again = find(ten_periods(data, unit)).regression.model
        assert again is not None
        for one, same in zip(found.model.terms, again.terms, strict=True):
            assert one[1:] == pytest.approx(same[1:], rel=1e-6, nan_ok=True)


def test_no_regression_where_nobody_fell(data: Data):
    table = data.table.assign(fell=0.0, ending="end of run")
    found = find(dataclasses.replace(data, table=table)).regression
    assert found.model is None
    assert found.none_because == "no run fell, so no factor makes a difference"


def test_a_column_that_follows_from_others_is_left_out(data: Data):
    """The same levels under two names."""
    again = data.factors[0]._replace(name="haptics", label="haptics")
    table = data.table.assign(haptics=data.table["law"])
    found = find(
        dataclasses.replace(data, table=table, factors=(*data.factors, again), comparisons=())
    ).regression
    assert found.left_out == ("haptics off",)


def test_main_effects_that_do_not_fit_are_found(data: Data):
    """All fall where exactly one of law and roll cue is off."""
    table = data.table
    odd = (table["law"] == "off") ^ ~table["vision.roll_cue"]
    noise = table["seed"] == 3  # so that nothing is separated
    found = find(dataclasses.replace(data, table=table.assign(fell=(odd ^ noise).astype(float))))
    assert found.regression.fit is not None
    assert found.regression.fit.p < 1e-6
