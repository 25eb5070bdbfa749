"""A hands-off run in the virtual rig against the sampled linear prediction."""

import math

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario
from bikesim.model.law import Law
from bikesim.model.sampled import sampled_eigenvalues


class Rows:
    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)


def hands_off(law: Law, period: float, seconds: float = 6.0) -> np.ndarray:
    """Roll [rad] at each tick at 3.5 m/s, from 0.01 degrees."""
    scenario = {
        "rider": "hands-off", "law": law.value, "speed": 3.5, "period": period, "duration": seconds,
        "start": {"roll_deg": 0.01},
    }  # fmt: skip
    record = Rows()
    ride_parts(build(Scenario(**scenario)), record)
    return np.array([row[6] for row in record.rows])


def fitted_weave(roll: np.ndarray, period: float, spacing: float = 0.04) -> complex:
    """The growing oscillation after 3 s, when the other modes have died away."""
    every = round(spacing / period)
    y = roll[round(3 / period) :: every]
    (a, b), *_ = np.linalg.lstsq(np.column_stack([y[1:-1], y[:-2]]), y[2:], rcond=None)
    z = complex(np.roots([1, -a, -b])[0])
    s = np.log(z) / (every * period)
    return complex(s.real, abs(s.imag))


def predicted_weave(law: Law, period: float, delay: int) -> complex:
    values = sampled_eigenvalues(
        bicycles.load("benchmark"), law, 3.5, period=period, delay_periods=delay
    )
    return complex(next(s for s in values if s.imag > 1e-6))


class TestGrowth:
    """Of a hands-off run at 3.5 m/s in the virtual rig, against the sampled linear prediction."""

    @pytest.mark.parametrize("law", [Law.PAPER, Law.MOMENTUM])
    def test_at_1_khz_with_or_without_one_period_of_delay(self, law: Law):
        found = fitted_weave(hands_off(law, 1e-3), 1e-3)
        for delay in (0, 1):
            expected = predicted_weave(law, 1e-3, delay)
            assert found.real == pytest.approx(expected.real, rel=0.005)
            assert found.imag == pytest.approx(expected.imag, rel=0.005)

    @pytest.mark.parametrize("law", [Law.PAPER, Law.MOMENTUM])
    @pytest.mark.parametrize("period", [5e-3, 20e-3])
    def test_of_a_slower_loop_on_the_same_physics(self, law: Law, period: float):
        found = fitted_weave(hands_off(law, period), period)
        expected = predicted_weave(law, period, 0)
        assert found.real == pytest.approx(expected.real, rel=0.005)
        assert found.imag == pytest.approx(expected.imag, rel=0.005)

    def test_with_haptics_off_is_that_of_a_pendulum(self):
        roll = hands_off(Law.OFF, 1e-3, seconds=1.5)
        lam = math.sqrt(9.81 * 80.95 / 80.81722)
        assert roll[-1] == pytest.approx(math.radians(0.01) * math.cosh(lam * 1.499), rel=1e-9)
