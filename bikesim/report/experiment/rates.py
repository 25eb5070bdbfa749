"""How often: shares with their intervals, one sample or two of the same seeds."""

import math
from typing import NamedTuple

CONFIDENCE = 0.95


class Rate(NamedTuple):
    """It happened in `events` of `runs`: the share, and its Wilson interval."""

    events: int
    runs: int
    share: float
    low: float
    high: float


class PairedRates(NamedTuple):
    """Two conditions over the same seeds, by what happened in each pair.

    `both`, `first`, `second`, `neither` count pairs in which it happened in both, in the first
    condition alone, and so on. `difference` is the second share less the first, with its interval;
    `p` is that of the exact McNemar test.
    """

    both: int
    first: int
    second: int
    neither: int
    difference: float
    low: float
    high: float
    p: float


def normal_quantile(confidence: float = CONFIDENCE) -> float:
    """z of a two-sided interval: 1.96 at 0.95."""
    from statistics import NormalDist

    return NormalDist().inv_cdf(0.5 + confidence / 2)


def wilson(events: int, runs: int, confidence: float = CONFIDENCE) -> Rate:
    """The share with Wilson's score interval [Wilson 1927; Brown, Cai & DasGupta 2001, eq. 4]."""
    if runs == 0:
        return Rate(0, 0, math.nan, math.nan, math.nan)
    z2 = normal_quantile(confidence) ** 2
    share = events / runs
    centre = (events + z2 / 2) / (runs + z2)
    half = math.sqrt(z2 * (share * (1 - share) * runs + z2 / 4)) / (runs + z2)
    # At none and all the limits are 0 and 1, which rounding would miss.
    low = 0.0 if events == 0 else centre - half
    high = 1.0 if events == runs else centre + half
    return Rate(events, runs, share, low, high)


def paired_rates(
    both: int, first: int, second: int, neither: int, confidence: float = CONFIDENCE
) -> PairedRates:
    """Exact McNemar test, and the interval of the difference by Bonett & Price (2012, eq. 4)."""
    runs = both + first + second + neither
    if runs == 0:
        return PairedRates(0, 0, 0, 0, math.nan, math.nan, math.nan, math.nan)
    one, other = (first + 1) / (runs + 2), (second + 1) / (runs + 2)
    spread = math.sqrt((one + other - (other - one) ** 2) / (runs + 2))
    half = normal_quantile(confidence) * spread
    low, high = max(-1.0, other - one - half), min(1.0, other - one + half)
    difference = (second - first) / runs
    return PairedRates(both, first, second, neither, difference, low, high, mcnemar(first, second))


def mcnemar(first: int, second: int) -> float:
    """Two-sided p of the exact test: of `first + second` pairs that differ, half each way."""
    pairs, fewer = first + second, min(first, second)
    if pairs == 0:
        return 1.0
    tail = sum(math.comb(pairs, k) for k in range(fewer + 1))
    return min(1.0, 2 * tail / 2**pairs)


def holm(p_values: list[float]) -> list[float]:
    """p adjusted for all of them by Holm's step-down method [Holm 1979]; NaN stays NaN."""
    made = sorted(i for i, p in enumerate(p_values) if not math.isnan(p))
    adjusted, largest = [math.nan] * len(p_values), 0.0
    for rank, i in enumerate(sorted(made, key=lambda i: p_values[i])):
        largest = max(largest, min(1.0, (len(made) - rank) * p_values[i]))
        adjusted[i] = largest
    return adjusted
