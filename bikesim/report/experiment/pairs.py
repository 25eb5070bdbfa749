"""Two conditions over the same seeds: how much a metric differs, and how surely."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.report.experiment.rates import CONFIDENCE, normal_quantile

Reals = NDArray[np.float64]

FEWEST = 6
"""Pairs below which nothing is tested: Wilcoxon's two-sided p cannot be under 0.05 with fewer."""

_MOST_EXACT = 50  # pairs up to which ranks are counted; beyond, the normal law is as good


class PairedDifference(NamedTuple):
    """The differences d = second - first of `pairs`, in the metric's unit.

    `mean` with Student's interval; `median` is Hodges & Lehmann's shift, with the interval that
    belongs to Wilcoxon's test; `effect` is Cohen's d_z = mean / standard deviation, with its
    interval. `p_t` and `p_wilcoxon` are two-sided. NaN with fewer than FEWEST pairs.
    """

    pairs: int
    mean: float
    mean_low: float
    mean_high: float
    median: float
    median_low: float
    median_high: float
    effect: float
    effect_low: float
    effect_high: float
    p_t: float
    p_wilcoxon: float


def paired_difference(
    first: Reals, second: Reals, confidence: float = CONFIDENCE
) -> PairedDifference:
    """Of a metric in two conditions, (m,) each, in order of their seeds; pairs with NaN left out.

    Wilcoxon 1945, Hodges & Lehmann 1963; d_z: Cohen 1988, its standard error: Hedges & Olkin
    1985.
    """
    from scipy import stats

    change = second - first
    change = change[np.isfinite(change)]
    n = len(change)
    if n < FEWEST:
        return PairedDifference(n, *(math.nan,) * 11)
    mean, spread = float(change.mean()), float(change.std(ddof=1))
    half = float(stats.t.ppf(0.5 + confidence / 2, n - 1)) * spread / math.sqrt(n)
    low, median, high = _hodges_lehmann(change, confidence)
    if np.all(change == change[0]):
        # Equal runs, or a constant shift: a spread of nothing says nothing of chance.
        p = 1.0 if change[0] == 0 else math.nan
        effect = 0.0 if change[0] == 0 else math.nan
        return PairedDifference(
            n, mean, mean, mean, median, median, median, effect, effect, effect, p, p
        )
    effect = mean / spread
    error = normal_quantile(confidence) * math.sqrt(1 / n + effect**2 / (2 * n))
    return PairedDifference(
        n, mean, mean - half, mean + half, median, low, high,
        effect, effect - error, effect + error,
        p_t=float(stats.ttest_1samp(change, 0.0).pvalue),
        p_wilcoxon=float(stats.wilcoxon(change).pvalue),
    )  # fmt: skip


def _hodges_lehmann(change: Reals, confidence: float) -> tuple[float, float, float]:
    """Lower limit, shift and upper limit from the Walsh averages (d_i + d_j) / 2, i ≤ j.

    The limits leave out as many of them at each end as Wilcoxon's statistic may be without being
    significant [Hollander, Wolfe & Chicken 2014, sec. 3.3].
    """
    ordered = np.sort(change)
    n = len(ordered)
    count = n * (n + 1) // 2
    out = max(0, signed_rank_quantile(n, (1 - confidence) / 2) - 1)
    ranks = (out, (count - 1) // 2, count // 2, count - 1 - out)
    low, lower, upper, high = (_walsh_average(ordered, rank) for rank in ranks)
    return low, (lower + upper) / 2, high


@lru_cache(maxsize=128)
def signed_rank_quantile(pairs: int, tail: float) -> int:
    """The smallest v with P(V ≤ v) ≥ `tail`, of Wilcoxon's signed-rank statistic V under no effect.

    Counted up to 50 pairs; beyond, by the normal law with a correction for continuity.
    """
    if pairs > _MOST_EXACT:
        mean = pairs * (pairs + 1) / 4
        spread = math.sqrt(pairs * (pairs + 1) * (2 * pairs + 1) / 24)
        return math.ceil(mean - 0.5 - normal_quantile(1 - 2 * tail) * spread)
    chance = np.zeros(pairs * (pairs + 1) // 2 + 1)
    chance[0] = 1.0
    for rank in range(1, pairs + 1):  # of either sign with probability 1/2
        chance[rank:] += chance[:-rank].copy()
        chance /= 2
    return int(np.searchsorted(np.cumsum(chance), tail))


def _walsh_average(ordered: Reals, rank: int) -> float:
    """The Walsh average of that rank, the smallest 0, of sorted values; by bisection.

    All of them would be 50 million of 10,000 pairs; how many are below a value is soon counted.
    """
    low, high = float(ordered[0]), float(ordered[-1])
    while low < (middle := low + (high - low) / 2) < high:
        if _at_most(ordered, middle) > rank:
            high = middle
        else:
            low = middle
    return high if _at_most(ordered, low) <= rank else low


def _at_most(ordered: Reals, value: float) -> int:
    """How many Walsh averages are at most this."""
    sums = np.searchsorted(ordered, 2 * value - ordered, side="right").sum()
    return int(sums + np.searchsorted(ordered, value, side="right")) // 2
