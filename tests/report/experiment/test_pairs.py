import math

import numpy as np
import pytest
from scipy import stats

from bikesim.report.experiment.pairs import FEWEST, paired_difference, signed_rank_quantile

# Hamilton depression scores before and after a tranquilliser: Hollander, Wolfe & Chicken 2014,
# Table 3.1 and Examples 3.1, 3.3 and 3.4.
BEFORE = np.array([1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30])
AFTER = np.array([0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29])


def test_a_published_example():
    found = paired_difference(BEFORE, AFTER)
    assert found.pairs == 9
    assert found.p_wilcoxon == pytest.approx(0.039, abs=5e-4)
    assert found.median == pytest.approx(-0.46, abs=5e-4)
    assert (found.median_low, found.median_high) == pytest.approx((-0.786, -0.010), abs=5e-4)


# Largest W that is significant at 0.05, two-sided [McCornack 1965; Zar 2010, Table B.12].
CRITICAL = {
    6: 0, 7: 2, 8: 3, 9: 5, 10: 8, 11: 10, 12: 13, 13: 17, 14: 21, 15: 25, 16: 29, 17: 34, 18: 40,
    19: 46, 20: 52, 21: 58, 22: 65, 23: 73, 24: 81, 25: 89,
}  # fmt: skip


def test_critical_values_are_those_of_the_published_table():
    assert {n: signed_rank_quantile(n, 0.025) - 1 for n in CRITICAL} == CRITICAL


def test_the_normal_law_goes_on_where_counting_ends():
    """Against counts in whole numbers, of any number of pairs."""
    for n in (51, 75, 120):
        ways = [1]
        for rank in range(1, n + 1):
            ways = [
                (ways[v] if v < len(ways) else 0) + (ways[v - rank] if v >= rank else 0)
                for v in range(len(ways) + rank)
            ]
        below, v = ways[0], 0
        while 40 * below < 2**n:
            v += 1
            below += ways[v]
        assert abs(signed_rank_quantile(n, 0.025) - v) <= 1


@pytest.mark.parametrize("n", [6, 7, 8, 12, 30, 50])
def test_the_interval_is_what_the_exact_test_does_not_reject(n: int):
    change = np.random.default_rng(n).normal(0.4, 1, n)
    found = paired_difference(np.zeros(n), change)
    for limit, out in ((found.median_low, -1e-9), (found.median_high, 1e-9)):
        assert stats.wilcoxon(change - limit - out, method="exact").pvalue < 0.05
        assert stats.wilcoxon(change - limit + out, method="exact").pvalue >= 0.05


def test_all_walsh_averages_sorted_give_the_same():
    change = np.round(np.random.default_rng(1).normal(0.3, 1, 60), 1)  # with ties
    found = paired_difference(np.zeros(60), change)
    i, j = np.triu_indices(60)
    walsh = np.sort((change[i] + change[j]) / 2)
    assert found.median == pytest.approx(np.median(walsh), abs=1e-12)
    assert np.isclose(walsh, found.median_low, atol=1e-12).any()
    assert np.isclose(walsh, found.median_high, atol=1e-12).any()


def test_means_are_those_of_students_test():
    first, second = np.random.default_rng(2).normal(size=(2, 30))
    found, test = paired_difference(first, second), stats.ttest_rel(second, first)
    interval = test.confidence_interval()
    assert found.p_t == pytest.approx(test.pvalue)
    assert (found.mean_low, found.mean_high) == pytest.approx((interval.low, interval.high))
    assert found.effect == pytest.approx(test.statistic / math.sqrt(30))
    assert found.effect_low < found.effect < found.effect_high


def test_pairs_in_which_one_is_missing_do_not_count():
    first = np.array([*BEFORE, math.nan, 1.0])
    second = np.array([*AFTER, 1.0, math.nan])
    assert paired_difference(first, second) == paired_difference(BEFORE, AFTER)


def test_too_few_pairs_say_nothing():
    found = paired_difference(BEFORE[: FEWEST - 1], AFTER[: FEWEST - 1])
    assert found.pairs == FEWEST - 1
    assert all(math.isnan(value) for value in found[1:])


def test_equal_runs_do_not_differ():
    found = paired_difference(BEFORE, BEFORE)
    assert (found.mean, found.median, found.effect, found.p_wilcoxon) == (0, 0, 0, 1)


def test_ten_thousand_pairs():
    change = np.random.default_rng(3).normal(0.2, 1, 10_000)
    found = paired_difference(np.zeros(10_000), change)
    assert found.median == pytest.approx(0.2, abs=0.03)
    assert found.median_low < 0.2 < found.median_high
