import math
from itertools import product

import pytest
from scipy import stats
from statsmodels.stats.multitest import multipletests

from bikesim.report.experiment.rates import holm, mcnemar, paired_rates, wilson


@pytest.mark.parametrize(
    ("events", "runs", "low", "high"),
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0000, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_as_printed(events: int, runs: int, low: float, high: float):
    """Newcombe 1998, Statistics in Medicine 17, 857-872, Table I, method 3."""
    rate = wilson(events, runs)
    assert (rate.low, rate.high) == pytest.approx((low, high), abs=5e-5)
    assert rate.share == events / runs


def test_all_is_the_mirror_of_none():
    none, every = wilson(0, 25), wilson(25, 25)
    assert (every.low, every.high) == pytest.approx((1 - none.high, 1 - none.low))


def test_of_no_runs_there_is_no_rate():
    assert math.isnan(wilson(0, 0).share)


@pytest.mark.parametrize(("first", "second"), [(0, 0), (0, 5), (3, 9), (10, 10), (40, 61)])
def test_mcnemar_is_the_exact_binomial_test(first: int, second: int):
    expected = stats.binomtest(first, first + second).pvalue if first + second else 1.0
    assert mcnemar(first, second) == pytest.approx(expected)


def test_the_difference_is_of_the_second_less_the_first():
    found = paired_rates(both=5, first=2, second=12, neither=6)
    assert found.difference == pytest.approx(10 / 25)
    assert 0 < found.low < found.difference < found.high < 1
    turned = paired_rates(both=5, first=12, second=2, neither=6)
    assert (turned.low, turned.high) == pytest.approx((-found.high, -found.low))


@pytest.mark.parametrize("p", [(0.1, 0.2), (0.05, 0.5), (0.02, 0.1)])
def test_the_interval_of_the_difference_holds_as_often_as_it_says(p: tuple[float, float]):
    """The chance, over all outcomes of 25 pairs, that it has the true difference in it."""
    runs, (p_first, p_second) = 25, p
    held = 0.0
    for first, second in product(range(runs + 1), repeat=2):
        same = runs - first - second
        if same >= 0:
            chance = stats.multinomial.pmf(
                [first, second, same], runs, [p_first, p_second, 1 - p_first - p_second]
            )
            found = paired_rates(0, first, second, same)
            held += chance * (found.low <= p_second - p_first <= found.high)
    assert 0.94 <= held <= 0.995


def test_no_pairs_no_difference():
    assert math.isnan(paired_rates(0, 0, 0, 0).difference)


def test_holm_is_that_of_statsmodels():
    p_values = [0.01, 0.04, 0.03, 0.005, 0.2, 0.9]
    expected = multipletests(p_values, method="holm")[1]
    assert holm(p_values) == pytest.approx(expected)


def test_a_test_that_was_not_made_does_not_count():
    corrected = holm([0.01, math.nan, 0.03])
    assert corrected[0] == 0.02
    assert math.isnan(corrected[1])
