"""The statistics of an experiment: of each condition, of the factors, of pairs of conditions."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.metric_table import FALL_TIME, OF_ALL_RUNS
from bikesim.report.experiment.data import Comparison, Condition, Data
from bikesim.report.experiment.factors import Regression, regression
from bikesim.report.experiment.pairs import PairedDifference, paired_difference
from bikesim.report.experiment.rates import (
    PairedRates,
    Rate,
    holm,
    paired_rates,
    wilson,
)
from bikesim.report.experiment.survival import Survival, kaplan_meier, ridden


class Middle(NamedTuple):
    """A metric over the `runs` of a condition that have it: median with its interval, quartiles.

    Of the time of the fall by Kaplan-Meier, over all runs: NaN where fewer have fallen.
    """

    metric: str
    runs: int
    median: float
    low: float
    high: float
    lower_quartile: float
    upper_quartile: float


class ConditionFindings(NamedTuple):
    """Of one condition: how many fell, when, and its metrics.

    `faults` are runs that something else ended before their time.
    """

    condition: Condition
    falls: Rate
    faults: int
    survival: Survival
    metrics: tuple[Middle, ...]


class MetricContrast(NamedTuple):
    """A metric in two conditions, pairs of runs that both stayed up; p by Holm over all tests."""

    metric: str
    difference: PairedDifference
    p_holm: float


class Contrast(NamedTuple):
    """Two conditions over the same seeds."""

    comparison: Comparison
    falls: PairedRates
    falls_p_holm: float
    metrics: tuple[MetricContrast, ...]


class Findings(NamedTuple):
    """All that the report says in figures. `tests` were made in the contrasts, for Holm."""

    conditions: tuple[ConditionFindings, ...]
    regression: Regression
    contrasts: tuple[Contrast, ...]
    tests: int


def find(data: Data) -> Findings:
    """The statistics of a data."""
    contrasts, tests = _contrasts(data)
    return Findings(
        tuple(_of_condition(data, condition) for condition in data.conditions),
        regression(data),
        contrasts,
        tests,
    )


def _of_condition(data: Data, condition: Condition) -> ConditionFindings:
    fell = data.values(condition.name, "fell") > 0
    until = ridden(*(data.values(condition.name, name) for name in ("duration", FALL_TIME)))
    whole = data.whole(condition.name)
    survival = kaplan_meier(until, fell)
    metrics = tuple(
        _middle_fall(survival, len(fell))
        if name == FALL_TIME
        else _middle(name, values if name in OF_ALL_RUNS else values[whole])
        for name in data.metrics
        for values in [data.values(condition.name, name)]
    )
    falls, faults = wilson(int(fell.sum()), len(fell)), int((~whole & ~fell).sum())
    return ConditionFindings(condition, falls, faults, survival, metrics)


def _middle_fall(survival: Survival, runs: int) -> Middle:
    """Of the time of the fall: those who did not fall would have fallen later, or never."""
    median, low, high = survival.median, survival.median_low, survival.median_high
    quartiles = survival.quantile(0.25), survival.quantile(0.75)
    return Middle(FALL_TIME, runs, median, low, high, *quartiles)


def _middle(metric: str, values: NDArray[np.float64]) -> Middle:
    """Median, with the interval between order statistics that holds whatever the distribution."""
    values = np.sort(values[np.isfinite(values)])
    n = len(values)
    if n == 0:
        return Middle(metric, 0, *(math.nan,) * 5)
    quartiles = (float(q) for q in np.quantile(values, (0.5, 0.25, 0.75)))
    median, lower, upper = quartiles
    low, high = _median_interval(values)
    return Middle(metric, n, median, low, high, lower, upper)


def _median_interval(ordered: NDArray[np.float64]) -> tuple[float, float]:
    """Of at least 95 % by the binomial distribution; NaN where n is too small to have one."""
    from scipy.stats import binom

    n = len(ordered)
    out = int(binom.ppf(0.025, n, 0.5)) - 1
    if out < 0:
        return math.nan, math.nan
    return float(ordered[out]), float(ordered[n - 1 - out])


def _contrasts(data: Data) -> tuple[tuple[Contrast, ...], int]:
    made = [_contrast(data, comparison) for comparison in data.comparisons]
    p_values = [p for falls, metrics in made for p in _p_values(falls, metrics)]
    corrected = iter(holm(p_values))
    contrasts = tuple(
        Contrast(
            comparison,
            falls,
            next(corrected),
            tuple(
                MetricContrast(name, difference, next(corrected))
                for name, difference in zip(_compared(data), metrics, strict=True)
            ),
        )
        for comparison, (falls, metrics) in zip(data.comparisons, made, strict=True)
    )
    return contrasts, sum(not math.isnan(p) for p in p_values)


def _p_values(falls: PairedRates, metrics: tuple[PairedDifference, ...]) -> list[float]:
    return [falls.p, *(difference.p_wilcoxon for difference in metrics)]


def _compared(data: Data) -> tuple[str, ...]:
    """Falls are compared on their own."""
    return tuple(name for name in data.metrics if name not in OF_ALL_RUNS)


def _contrast(
    data: Data, comparison: Comparison
) -> tuple[PairedRates, tuple[PairedDifference, ...]]:
    names = _compared(data)
    first, second = data.paired(comparison, ("fell", *names))
    one, other = first[1] > 0, second[1] > 0
    falls = paired_rates(
        int((one & other).sum()),
        int((one & ~other).sum()),
        int((~one & other).sum()),
        int((~one & ~other).sum()),
    )
    whole = (first[0] > 0) & (second[0] > 0)
    return falls, tuple(
        paired_difference(first[i][whole], second[i][whole]) for i in range(2, len(names) + 2)
    )
