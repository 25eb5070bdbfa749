import math

import numpy as np
import pytest
import statsmodels.api as sm
from scipy import stats

from bikesim.report.experiment import logistic
from bikesim.report.experiment.logistic import logistic_regression, separated

NAMES = ("constant", "group")


def table(counts: tuple[int, int], falls: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Two groups of so many runs, so many of which fell."""
    group = np.repeat([0.0, 1.0], counts)
    fell = np.concatenate([np.arange(n) < k for n, k in zip(counts, falls, strict=True)])
    return np.column_stack([np.ones(sum(counts)), group]), fell


def noisy(runs: int = 400) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(0)
    design = np.column_stack(
        [np.ones(runs), random.integers(0, 2, runs), random.normal(size=runs).round(1)]
    )
    odds = design @ [-1.0, 0.8, 1.2]
    return design, random.random(runs) < 1 / (1 + np.exp(-odds))


def test_maximum_likelihood_is_that_of_statsmodels():
    design, fell = noisy()
    found = logistic_regression(design, fell, ("a", "b", "c"))
    other = sm.Logit(fell.astype(float), design).fit(disp=0)
    assert found.method == "maximum likelihood"
    assert [term.estimate for term in found.terms] == pytest.approx(other.params, abs=1e-6)


def test_p_is_that_of_the_likelihood_ratio():
    design, fell = noisy()
    whole, without = (
        sm.Logit(fell.astype(float), design[:, columns]).fit(disp=0).llf
        for columns in ([0, 1, 2], [0, 2])
    )
    expected = stats.chi2.sf(2 * (whole - without), 1)
    term = logistic_regression(design, fell, ("a", "b", "c")).terms[1]
    assert term.p == pytest.approx(expected, rel=1e-4)


def test_at_the_limits_the_likelihood_has_fallen_by_what_it_may():
    design, fell = noisy()
    term = logistic_regression(design, fell, ("a", "b", "c")).terms[1]
    top = sm.Logit(fell.astype(float), design).fit(disp=0).llf
    for limit in (term.low, term.high):
        rest = sm.GLM(
            fell.astype(float), design[:, [0, 2]], family=sm.families.Binomial(),
            offset=limit * design[:, 1],
        ).fit()  # fmt: skip
        assert 2 * (top - rest.llf) == pytest.approx(3.841, abs=0.05)


def by_period(unit: float, offset: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Ten loop periods of 1 to 10 ms, in a unit of so many a second, 60 runs each."""
    random = np.random.default_rng(1)
    period = np.repeat(np.arange(1, 11) * 1e-3, 60)
    fell = random.random(600) < 1 / (1 + np.exp(-1100 * (period - 0.0055)))
    return np.column_stack([np.ones(600), unit * period + offset]), fell


@pytest.mark.parametrize(("unit", "offset"), [(1.0, 0.0), (1e3, 0.0), (1e-6, 0.0), (1.0, 1.0)])
def test_the_answer_does_not_depend_on_the_unit(unit: float, offset: float):
    """The slope of statsmodels, in ms, and limits where the likelihood has fallen as it may."""
    design, fell = by_period(1e3)
    other = sm.Logit(fell.astype(float), design).fit(disp=0)
    found = logistic_regression(*by_period(unit, offset), NAMES)
    slope = found.terms[1]
    assert found.converged
    assert slope.estimate * unit / 1e3 == pytest.approx(other.params[1], rel=1e-6)
    for limit in (slope.low, slope.high):
        rest = sm.GLM(
            fell.astype(float), design[:, :1], family=sm.families.Binomial(),
            offset=limit * unit / 1e3 * design[:, 1],
        ).fit()  # fmt: skip
        assert 2 * (other.llf - rest.llf) == pytest.approx(3.841, abs=0.05)


@pytest.mark.parametrize("unit", [1.0, 1e3])
def test_nor_does_it_where_falls_are_separated(unit: float):
    design, _ = by_period(1.0)
    fell = design[:, 1] > 0.0055
    one, other = (
        logistic_regression(design * [1.0, by], fell, NAMES).terms[1] for by in (1.0, unit)
    )
    assert 0 < one.low < one.estimate < one.high < math.inf
    assert np.array(other[1:4]) * unit == pytest.approx(one[1:4], rel=1e-6)


def test_a_fit_that_does_not_converge_says_so(monkeypatch: pytest.MonkeyPatch):
    design, fell = noisy()
    assert logistic_regression(design, fell, ("a", "b", "c")).converged
    monkeypatch.setattr(logistic, "_STEPS", 2)
    assert not logistic_regression(design, fell, ("a", "b", "c")).converged


@pytest.mark.parametrize(("counts", "falls"), [((20, 20), (0, 20)), ((25, 30), (0, 7))])
def test_firth_of_two_groups_is_half_a_run_more_in_each_cell(
    counts: tuple[int, int], falls: tuple[int, int]
):
    """Firth 1993: with a rate for each group the penalty adds 1/2 to both cells of each."""
    found = logistic_regression(*table(counts, falls), NAMES)
    odds = [math.log((k + 0.5) / (n - k + 0.5)) for n, k in zip(counts, falls, strict=True)]
    assert found.separated
    assert found.method == "Firth"
    assert [term.estimate for term in found.terms] == pytest.approx(
        [odds[0], odds[1] - odds[0]], abs=1e-5
    )
    group = found.terms[1]
    assert 0 < group.low < group.estimate < group.high < math.inf
    assert group.p < 0.05


@pytest.mark.parametrize(
    ("falls", "expected"),
    [((0, 20), True), ((3, 20), True), ((0, 5), True), ((3, 15), False), ((0, 0), True)],
    ids=["wholly", "one group all", "one group none", "mixed", "no falls"],
)
def test_separation_is_found(falls: tuple[int, int], expected: bool):
    assert separated(*table((20, 20), falls)) is expected


def test_separation_by_two_factors_together():
    """Falls only where both are off: neither column decides it alone."""
    one, other = (np.repeat(values, 10) for values in ([0, 0, 1, 1], [0, 1, 0, 1]))
    design = np.column_stack([np.ones(40), one, other]).astype(float)
    fell = (one == 1) & (other == 1)
    found = logistic_regression(design, fell, ("constant", "one", "other"))
    assert found.separated
    assert all(math.isfinite(term.estimate) for term in found.terms)
    assert found.terms[1].low > 0
    assert found.terms[2].low > 0


def test_thousands_of_runs_that_are_separated_by_many_terms():
    """As of a slow loop with a filter: all fall above a limit, none below it."""
    levels = np.arange(6)
    a, b = (grid.ravel().repeat(50) for grid in np.meshgrid(levels, levels))
    columns = [a == level for level in levels[1:]] + [b == level for level in levels[1:]]
    design = np.column_stack([np.ones(len(a)), *columns]).astype(float)
    names = tuple(f"term {i}" for i in range(design.shape[1]))
    found = logistic_regression(design, a + b > 5, names)
    for term in found.terms[1:]:
        assert term.low <= term.estimate <= term.high
        assert math.isfinite(term.estimate)
