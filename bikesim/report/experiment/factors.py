"""What each factor does to falling, all runs together: a regression."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.report.experiment.data import Data, Factor, shown
from bikesim.report.experiment.logistic import CONSTANT, Logistic, logistic_regression

_MOST_LEVELS = 8  # of a factor with a term for each level; above it, one for its whole range


class Fit(NamedTuple):
    """How far main effects alone are from the conditions' own rates: deviance, and its test."""

    deviance: float
    degrees: int
    p: float


class Regression(NamedTuple):
    """The logistic regression of falls on the factors, or the reason why there is none.

    `reference`: factor and level that the terms of its other levels are held against.
    """

    model: Logistic | None
    fit: Fit | None
    reference: tuple[tuple[str, str], ...]
    left_out: tuple[str, ...]
    none_because: str = ""


def regression(data: Data) -> Regression:
    """Main effects of all factors over the grid; each level against the first of its factor.

    Of a number with many levels there is one term, linear in it: the log odds that its largest
    level has more than its least.
    """
    data = _of_grid(data)
    fell = data.table["fell"].to_numpy(np.float64) > 0
    factors = [factor for factor in data.factors if len(factor.levels) > 1]
    if not factors:
        return Regression(None, None, (), (), "no factor has more than one level")
    if not len(fell):
        return Regression(None, None, (), (), "no condition of the grid was ridden")
    if fell.all() or not fell.any():
        what = "every run" if fell.all() else "no run"
        return Regression(None, None, (), (), f"{what} fell, so no factor makes a difference")
    columns = [(name, column) for factor in factors for name, column in _columns(data, factor)]
    names, design, left_out = _independent(columns, len(fell))
    model = logistic_regression(design, fell, names)
    reference = tuple(
        (factor.label, f"{shown(factor.levels[0])} {factor.unit}".rstrip())
        for factor in factors
        if not _is_slope(factor)
    )
    return Regression(model, _fit(data, model, design), reference, left_out)


def _of_grid(data: Data) -> Data:
    """Without the conditions beside the grid, which have no level of some factor."""
    grid = tuple(one for one in data.conditions if not one.beside)
    rows = data.table["condition"].isin([one.name for one in grid])
    return replace(data, conditions=grid, table=data.table[rows].reset_index(drop=True))


def _columns(data: Data, factor: Factor) -> list[tuple[str, NDArray[np.float64]]]:
    values = data.table[factor.name]
    if _is_slope(factor):
        low, high = min(factor.levels), max(factor.levels)
        name = f"{factor.label}, from {shown(low)} to {shown(high)} {factor.unit}".rstrip()
        return [(name, (values.to_numpy(np.float64) - low) / (high - low))]
    return [
        (factor.at(level), np.array([v == level for v in values], float))
        for level in factor.levels[1:]
    ]


def _is_slope(factor: Factor) -> bool:
    return factor.numeric and len(factor.levels) > _MOST_LEVELS


def _independent(
    columns: list[tuple[str, NDArray[np.float64]]], runs: int
) -> tuple[tuple[str, ...], NDArray[np.float64], tuple[str, ...]]:
    """Constant and columns, without those that follow from the ones before them."""
    names, kept, left_out = [CONSTANT], [np.ones(runs)], []
    for name, column in columns:
        rows = np.unique(np.column_stack([*kept, column]), axis=0)
        if np.linalg.matrix_rank(rows) == len(kept) + 1:
            names.append(name)
            kept.append(column)
        else:
            left_out.append(name)
    return tuple(names), np.column_stack(kept), tuple(left_out)


def _fit(data: Data, model: Logistic, design: NDArray[np.float64]) -> Fit | None:
    """Deviance of the model from one with a rate of its own for each condition."""
    from scipy import stats

    beta = np.array([term.estimate for term in model.terms])
    all_odds, names = design @ beta, data.table["condition"].to_numpy()
    all_fell = data.table["fell"].to_numpy(np.float64)
    deviance, cells = 0.0, 0
    for name in np.unique(names):
        inside = names == name
        falls, n, odds = float(all_fell[inside].sum()), int(inside.sum()), all_odds[inside][0]
        deviance += 2 * (_log_likelihood(falls, n) - falls * odds + n * np.logaddexp(0, odds))
        cells += 1
    degrees = cells - len(beta)
    if degrees < 1:
        return None
    return Fit(float(deviance), degrees, float(stats.chi2.sf(deviance, degrees)))


def _log_likelihood(falls: float, runs: int) -> float:
    share = falls / runs
    return sum(k * math.log(q) for k, q in ((falls, share), (runs - falls, 1 - share)) if k > 0)
