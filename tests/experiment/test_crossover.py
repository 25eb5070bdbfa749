import math

import numpy as np
import pytest
from scipy import signal

from bikesim.experiment.crossover import (
    butterworth_response,
    delay_response,
    loop_of_roll_disturbance,
    loop_of_steer_disturbance,
    margins,
)

LINES = np.geomspace(0.5, 20, 60)


def test_the_crossover_model():
    """McRuer & Jex 1967: L = ω_c e^{-jωτ} / jω crosses over at ω_c, with π/2 - ω_c τ of margin."""
    found = margins(LINES, 3.0 * delay_response(LINES, 0.2) / (1j * LINES))
    assert found.crossover_frequency == pytest.approx(3.0, rel=1e-6)
    assert found.phase_margin == pytest.approx(math.pi / 2 - 0.6, abs=2e-3)


def test_an_unstable_loop_has_a_negative_margin():
    found = margins(LINES, 5.0 * delay_response(LINES, 0.4) / (1j * LINES))
    assert found.phase_margin == pytest.approx(math.pi / 2 - 2.0, abs=5e-3)


def test_the_last_fall_counts():
    """A gain that is above 1 from 1 to 4 and from 8 to 15 rad/s."""
    gain = np.where((LINES < 4) | ((LINES > 8) & (LINES < 15)), 2.0, 0.5)
    assert 14 < margins(LINES, gain * np.exp(-2j)).crossover_frequency < 16


@pytest.mark.parametrize("gain", [0.5, 2.0])
def test_no_fall_no_crossover(gain: float):
    assert all(math.isnan(value) for value in margins(LINES, np.full(60, gain + 0j)))


def test_both_disturbances_find_the_loop():
    """T = -R φ with R = 4 + 2 s, φ = P T + D d: the loop is R P whatever D is."""
    s = 1j * LINES
    rider, plant = 4 + 2 * s, 1 / (s**2 + s - 3)
    for from_disturbance in (plant, 0.3 / (s + 2)):
        roll = from_disturbance / (1 + rider * plant)
        assert loop_of_roll_disturbance(-rider * roll, roll, plant) == pytest.approx(rider * plant)
    torque = -rider * plant / (1 + rider * plant)
    assert loop_of_steer_disturbance(torque, np.ones(60, complex)) == pytest.approx(rider * plant)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_butterworth_is_that_of_scipy(order: int):
    b, a = signal.butter(order, 6.0, analog=True)
    expected = signal.freqs(b, a, LINES)[1]
    assert butterworth_response(LINES, 6.0, order) == pytest.approx(expected)
    assert np.array_equal(butterworth_response(LINES, None), np.ones(60))
