"""The best roll PD rider: SCIENCE.md section 3's case, and that no other gains are better."""

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.report.paper.tuning import RollPDLoop, rider_settings
from bikesim.rider.base import Arms
from bikesim.rider.linear import closed_loop, linear_rider, spectral_abscissa

BENCHMARK = bicycles.load("benchmark")
SOFT = Arms(0.1, 2.0, 5.0)
STIFF = Arms(0.1, 4.0, 20.0)


def loop(law: Law, arms: Arms = SOFT, delay: float = 0.2) -> RollPDLoop:
    return RollPDLoop(BENCHMARK, 3.5, law, delay=delay, arms=arms)


def test_soft_arms_balance_with_haptics_on():
    found = loop(Law.PAPER).best()
    assert found.growth_rate == pytest.approx(-0.277, abs=0.005)
    assert found.gains == pytest.approx((0.29, 0.71), abs=0.005)


def test_soft_arms_cannot_balance_with_haptics_off():
    assert loop(Law.OFF).best().growth_rate > 0.1


def test_stiff_arms_balance_with_haptics_off():
    assert loop(Law.OFF, STIFF).best().growth_rate < -0.5


def test_the_growth_rate_is_that_of_the_rider_with_these_gains():
    rider = linear_rider(rider_settings(0.2, SOFT, (1.3, -0.4)))
    expected = spectral_abscissa(closed_loop(BENCHMARK, 3.5, rider, law=Law.PAPER))
    assert loop(Law.PAPER).growth_rate((1.3, -0.4)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("start", [(0.3, 0.7), (20.0, 10.0), (-4.0, -1.0), (60.0, 2.0)])
@pytest.mark.parametrize("law", [Law.PAPER, Law.OFF])
def test_the_best_does_not_depend_on_the_start(law: Law, start: tuple[float, float]):
    expected = loop(law).best().growth_rate
    assert loop(law).best([start]).growth_rate == pytest.approx(expected, abs=0.003)


@pytest.mark.parametrize(
    ("law", "arms", "delay"),
    [(Law.OFF, SOFT, 0.2), (Law.OFF, Arms(0.1, 0.0, 0.0), 0.1), (Law.PAPER, STIFF, 0.3)],
)
def test_no_gains_of_a_wide_grid_are_better(law: Law, arms: Arms, delay: float):
    best = loop(law, arms, delay).best().growth_rate
    sizes = np.geomspace(0.1, 300, 12)
    gains = np.concatenate([-sizes, [0.0], sizes])
    other = loop(law, arms, delay)
    assert best <= min(other.growth_rate((p, d)) for p in gains for d in gains) + 1e-3
