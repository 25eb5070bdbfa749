"""Coded riders in the virtual rig, their decay held against linear theory."""

import cmath
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve

from bikesim import bicycles
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices


def ridden(**scenario: Any) -> tuple[np.ndarray, bool]:
    """Roll [rad] at each millisecond, and whether the bicycle fell."""
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    ending = ride_parts(build(Scenario(**{**scenario, "start": {"roll_deg": 1.0}})), Rows())
    return np.array([row[6] for row in rows]), ending.fell


def exponents(signal: np.ndarray, spacing: float, order: int) -> np.ndarray:
    """Exponents [1/s] of a sum of `order` exponentials, by linear prediction (Prony)."""
    columns = [signal[order - 1 - i : len(signal) - 1 - i] for i in range(order)]
    coefficients, *_ = np.linalg.lstsq(np.column_stack(columns), signal[order:], rcond=None)
    return np.log(np.roots([1, *-coefficients]).astype(complex)) / spacing


def test_the_rider_of_run_184_has_the_modes_that_are_known():
    """SCIENCE, Sec. 3; the loop's period makes them a few thousandths less stable."""
    roll, fell = ridden(bicycle="davis", rider="schwab2013-184", speed=3.19, duration=5.0)
    found = exponents(roll[2000::50], 0.05, order=6)
    assert not fell
    for mode in (-0.746 + 2.439j, -1.785 + 5.852j, -2.197 + 10.406j):
        assert np.abs(found - mode).min() < 0.02


def test_with_haptics_off_he_falls():
    _, fell = ridden(bicycle="davis", rider="schwab2013-184", speed=3.19, duration=5.0, law="off")
    assert fell


def characteristic(gains: tuple[float, float], delay: float) -> Callable[[complex], complex]:
    """det of roll PD, delay, muscles [H12], arms and simulator at 3.5 m/s, as a function of s."""
    mass, damping, stiffness = simulator_matrices(bicycles.load("benchmark"), Law.PAPER, 3.5)
    arms = np.diag([0, 1])
    mass, damping, stiffness = mass + 0.1 * arms, damping + 2 * arms, stiffness + 5 * arms

    def determinant(s: complex) -> complex:
        muscle = 900 / (s * s + 2 * 0.707 * 30 * s + 900)
        torque = muscle * cmath.exp(-s * delay) * (gains[0] + gains[1] * s)
        bicycle = s * s * mass + s * damping + stiffness
        return complex(np.linalg.det(bicycle - np.array([[0, 0], [torque, 0]])))

    return determinant


@pytest.mark.parametrize(
    ("gains", "delay", "near"),
    [
        ((0.30, 0.71), 0.2, -0.1 + 0.3j),
        ((0.43, 1.74), 0.2, -0.1 + 1.7j),
        ((0.43, 1.74), 0.1, -0.3 + 1.7j),
    ],
)
def test_the_roll_pd_rider_with_delay_and_arms_decays_as_his_equation_says(
    gains: tuple[float, float], delay: float, near: complex
):
    determinant = characteristic(gains, delay)

    def parts(x: np.ndarray) -> tuple[float, float]:
        value = determinant(complex(*x))
        return value.real, value.imag

    mode = complex(*fsolve(parts, (near.real, near.imag)))
    rider = {
        "name": "human", "roll_gain": gains[0], "roll_rate_gain": gains[1], "visual_delay": delay,
        "remnant_rms": 0.0,
    }  # fmt: skip
    roll, fell = ridden(rider=rider, duration=9.0)
    assert not fell
    assert np.abs(exponents(roll[3000::50], 0.05, order=3) - mode).min() < 5e-3
