"""Falling as a function of the factors: logistic regression that also stands separation."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.report.experiment.rates import CONFIDENCE, holm

Reals = NDArray[np.float64]

CONSTANT = "constant"
"""The name of the term that all runs have."""

_STEPS = 200
_TOLERANCE = 1e-8  # of the log odds of any run
_LARGEST_STEP = 3.0  # the same
# Of a coefficient's standard error.
_FIRST_REACH = 0.5
_FARTHEST = 100.0
_LIMIT_ERROR = 1e-3
_SLACK = 1e-12  # that a log likelihood loses to rounding


class Term(NamedTuple):
    """One coefficient β: the log odds of a fall it adds, its interval, and the test of β = 0.

    exp(β) is the odds ratio. A limit that the likelihood does not have is infinite. `p_holm` is
    corrected for the tests of all terms but the constant, of which nothing is asked: NaN.
    """

    name: str
    estimate: float
    low: float
    high: float
    p: float
    p_holm: float


class Logistic(NamedTuple):
    """The fit to `runs`, of which `falls`. `method` is "maximum likelihood" or "Firth".

    `separated` says that some combination of the terms tells falls from the others with no
    mistake, or with none but ties: then maximum likelihood has no answer, and Firth's penalised
    likelihood is used. Where not `converged`, figures are those of the last step.
    """

    terms: tuple[Term, ...]
    runs: int
    falls: int
    method: str
    separated: bool
    converged: bool


def logistic_regression(
    design: Reals, fell: NDArray[np.bool_], names: tuple[str, ...], confidence: float = CONFIDENCE
) -> Logistic:
    """log odds(fall) = X β; `design` X (m, k) with its column of ones, `fell` (m,), `names` (k,).

    Intervals and p of each coefficient are those of the profile likelihood, penalised by Firth's
    log √det(XᵀWX) where the data are separated [Firth 1993; Heinze & Schemper 2002]. In other
    units of a column its coefficient is another by the same factor, and nothing else.
    """
    largest = np.abs(design).max(axis=0)
    scale = np.where(largest > 0, largest, 1.0)
    rows, counts, falls = _grouped(design / scale, fell)
    split = separated(design / scale, fell)
    fit = _Likelihood(rows, counts, falls, penalised=split)
    best = fit.maximum()
    found = [_term(fit, best, i, name, confidence) for i, name in enumerate(names)]
    terms = [
        term._replace(estimate=term.estimate / by, low=term.low / by, high=term.high / by)
        for term, by in zip(found, scale.tolist(), strict=True)
    ]
    corrected = holm([math.nan if term.name == CONSTANT else term.p for term in terms])
    terms = tuple(term._replace(p_holm=p) for term, p in zip(terms, corrected, strict=True))
    method = "Firth" if split else "maximum likelihood"
    return Logistic(terms, len(fell), int(fell.sum()), method, split, fit.converged)


def separated(design: Reals, fell: NDArray[np.bool_]) -> bool:
    """Whether a β ≠ 0 has X β ≥ 0 for all that fell and ≤ 0 for all others, but not all 0.

    Found by linear programming [Albert & Anderson 1984; Konis 2007].
    """
    from scipy.optimize import linprog

    towards = np.unique(np.where(fell[:, None], design, -design), axis=0)
    found = linprog(
        -towards.sum(axis=0), A_ub=-towards, b_ub=np.zeros(len(towards)), bounds=(-1, 1)
    )
    return found.status == 0 and found.fun is not None and found.fun < -1e-7


class _Likelihood:
    """The log likelihood of grouped runs: rows (g, k) of X, and of each how many, how many fell.

    `converged` is False once a maximum was not found.
    """

    def __init__(self, rows: Reals, counts: Reals, falls: Reals, *, penalised: bool) -> None:
        self._rows, self._counts, self._falls = rows, counts, falls
        self._penalised = penalised
        self.converged = True

    def maximum(
        self, fixed: int | None = None, at: float = 0.0, *, near: Reals | None = None
    ) -> tuple[Reals, float]:
        """β and the log likelihood there, with one coefficient held at a value if so asked.

        Sought from `near`, by Newton's method with steps that never lose.
        """
        beta = np.zeros(self._rows.shape[1]) if near is None else near.copy()
        free = np.ones(len(beta), bool)
        if fixed is not None:
            free[fixed] = False
            # The others with it, as the curvature says: else a column far from zero moves all odds.
            information = self._information(self._rows @ beta)
            others = _solved(information[np.ix_(free, free)], information[free, fixed])
            beta[free] -= others * (at - beta[fixed])
            beta[fixed] = at
        value = self._value(beta)
        for _ in range(_STEPS):
            step = np.zeros(len(beta))
            score, information = self._score(beta)
            step[free] = _solved(information[np.ix_(free, free)], score[free])
            step *= min(1.0, _LARGEST_STEP / max(self._size(step), 1e-300))
            new = self._value(beta + step)
            while not new >= value - _SLACK and self._size(step) > _TOLERANCE:
                step /= 2
                new = self._value(beta + step)
            beta, value = beta + step, new
            if self._size(step) < _TOLERANCE:
                break
        else:
            self.converged = False
        return beta, value

    def standard_errors(self, beta: Reals) -> Reals:
        """Of each coefficient, by the curvature of the likelihood at β; 1 where it has none."""
        variance = np.diag(_solved(self._information(self._rows @ beta), np.eye(len(beta))))
        with np.errstate(invalid="ignore"):
            return np.where(np.isfinite(variance) & (variance > 0), np.sqrt(variance), 1.0)

    def _size(self, step: Reals) -> float:
        """The largest change of the log odds of any run: it is the same in all units."""
        return float(np.abs(self._rows @ step).max())

    def _value(self, beta: Reals) -> float:
        odds = self._rows @ beta
        value = float(self._falls @ odds - self._counts @ np.logaddexp(0.0, odds))
        if self._penalised:
            value += 0.5 * float(np.linalg.slogdet(self._information(odds))[1])
        return value

    def _information(self, odds: Reals) -> Reals:
        weight = self._counts * _share(odds) * _share(-odds)
        return (self._rows.T * weight) @ self._rows

    def _score(self, beta: Reals) -> tuple[Reals, Reals]:
        odds = self._rows @ beta
        share = _share(odds)
        information = self._information(odds)
        residual = self._falls - self._counts * share
        if self._penalised:
            weight = self._counts * share * (1 - share)
            leverage = np.einsum("ij,ji->i", self._rows, _solved(information, self._rows.T))
            residual = residual + weight * leverage * (0.5 - share)
        return self._rows.T @ residual, information


def _term(
    fit: _Likelihood, best: tuple[Reals, float], index: int, name: str, confidence: float
) -> Term:
    from scipy import stats

    beta, top = best
    drop = 0.5 * float(stats.chi2.ppf(confidence, 1))
    zero = max(fit.maximum(index, 0.0, near=start)[1] for start in (beta, None))
    p = float(stats.chi2.sf(max(0.0, 2 * (top - zero)), 1))
    error = float(fit.standard_errors(beta)[index])
    low, high = (_limit(fit, index, beta, top - drop, way * error) for way in (-1.0, 1.0))
    estimate = float(beta[index]) if abs(beta[index]) > _TOLERANCE * error else 0.0
    return Term(name, estimate, low, high, p, p_holm=math.nan)


def _limit(fit: _Likelihood, index: int, best: Reals, level: float, way: float) -> float:
    """Where the profile likelihood of one coefficient falls to a level, on one side of the best.

    `way` is the coefficient's standard error, negative for the lower side.
    """
    inside, above, near, reach = float(best[index]), math.inf, best, _FIRST_REACH
    # Step by step, each maximum sought from the one before it: far away the likelihood is flat.
    while True:
        outside = inside + way * reach
        beta, height = fit.maximum(index, outside, near=near)
        below = height - level
        if below <= 0:
            break
        inside, above, near, reach = outside, below, beta, 1.5 * reach
        if reach > _FARTHEST:
            return way * math.inf
    while abs(outside - inside) > _LIMIT_ERROR * abs(way):
        # The secant, but never so near an end that it would creep there.
        part = above / (above - below) if math.isfinite(above) else 0.5
        value = inside + min(max(part, 0.1), 0.9) * (outside - inside)
        beta, height = fit.maximum(index, value, near=near)
        if height > level:
            inside, above, near = value, height - level, beta
        else:
            outside, below = value, height - level
    return 0.5 * (inside + outside)


def _grouped(design: Reals, fell: NDArray[np.bool_]) -> tuple[Reals, Reals, Reals]:
    """Equal rows of the design together: thousands of runs are a few conditions."""
    rows, which = np.unique(design, axis=0, return_inverse=True)
    counts, falls = np.zeros(len(rows)), np.zeros(len(rows))
    np.add.at(counts, which.ravel(), 1.0)
    np.add.at(falls, which.ravel(), fell)
    return rows, counts, falls


def _solved(matrix: Reals, right: Reals) -> NDArray[Any]:
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:  # where all shares are 0 or 1 to the last bit
        return np.linalg.lstsq(matrix, right)[0]


def _share(odds: Reals) -> Reals:
    """1 / (1 + e^-x), without overflow."""
    return 0.5 * (1 + np.tanh(0.5 * odds))
