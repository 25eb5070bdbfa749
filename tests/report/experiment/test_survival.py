import math

import numpy as np
import pytest
from statsmodels.duration.survfunc import SurvfuncRight

from bikesim.report.experiment.survival import kaplan_meier

# Weeks of remission with 6-mercaptopurine (Freireich et al. 1963), + for censored: the example of
# Kalbfleisch & Prentice 2002, Table 1.2.
REMISSION = "6 6 6 6+ 7 9+ 10 10+ 11+ 13 16 17+ 19+ 20+ 22 23 25+ 32+ 32+ 34+ 35+"


def remission() -> tuple[np.ndarray, np.ndarray]:
    words = REMISSION.split()
    weeks = np.array([float(word.rstrip("+")) for word in words])
    return weeks, np.array([not word.endswith("+") for word in words])


def test_a_published_curve():
    found = kaplan_meier(*remission())
    assert found.time.tolist() == [6, 7, 10, 13, 16, 22, 23]
    printed = [0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448]
    assert found.share == pytest.approx(printed, abs=5e-4)
    assert found.at_risk.tolist() == [21, 17, 15, 12, 11, 7, 6]
    assert found.falls.tolist() == [3, 1, 1, 1, 1, 1, 1]
    assert found.median == 23


# Of the 21 patients with a placebo; the medians and their intervals on the log-log scale are
# published as 23 [13, not reached] and 8 [4, 11] weeks.
PLACEBO = [1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23]


def test_published_medians_with_their_intervals():
    found = kaplan_meier(*remission())
    assert (found.median, found.median_low, found.median_high) == (23, 13, math.inf)
    assert (found.quantile(0.25), math.isnan(found.quantile(0.75))) == (13, True)
    found = kaplan_meier(np.array(PLACEBO, float), np.ones(len(PLACEBO), bool))
    assert (found.median, found.median_low, found.median_high) == (8, 4, 11)


@pytest.mark.parametrize("seed", range(5))
def test_the_interval_of_the_median_is_that_of_statsmodels(seed: int):
    random = np.random.default_rng(seed)
    time, until = random.exponential(5, 40), random.uniform(2, 12, 40)
    duration, fell = np.minimum(time, until), time <= until
    found, other = kaplan_meier(duration, fell), SurvfuncRight(duration, fell)
    assert (found.median_low, found.median_high) == other.quantile_ci(0.5, method="cloglog")


def test_the_band_is_greenwoods_on_the_log_log_scale():
    weeks, ended = remission()
    found = kaplan_meier(weeks, ended)
    other = SurvfuncRight(weeks, ended)
    assert found.share == pytest.approx(other.surv_prob)
    spread = 1.959963984540054 * other.surv_prob_se / (other.surv_prob * np.log(other.surv_prob))
    assert found.low == pytest.approx(other.surv_prob ** np.exp(-spread))
    assert found.high == pytest.approx(other.surv_prob ** np.exp(spread))


def test_where_none_is_left_there_is_no_band():
    found = kaplan_meier(np.array([1.0, 2.0, 2.0]), np.array([True, True, True]))
    assert found.share == pytest.approx([2 / 3, 0])
    assert np.isnan([found.low[1], found.high[1]]).all()
    assert found.median == 2


def test_nobody_fell():
    found = kaplan_meier(np.full(5, 20.0), np.zeros(5, bool))
    assert len(found.time) == 0
    assert found.last == 20
    assert math.isnan(found.median)
    assert (math.isnan(found.median_low), found.median_high) == (True, math.inf)
