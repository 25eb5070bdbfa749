import math

import numpy as np
import pytest

from bikesim.identify.regressors import (
    Signals,
    block_change,
    block_mean,
    block_ticks,
    columns,
    recorded,
    torque,
)
from bikesim.identify.structure import Lags, structure

from .conftest import PERIOD

ROLL_PD = structure("roll-pd")


def test_a_block_is_20_ms_or_a_tick():
    assert [block_ticks(period) for period in (0.001, 0.002, 0.005, 0.02, 0.05)] == [
        20,
        10,
        4,
        1,
        1,
    ]


def test_means_and_changes_over_blocks():
    values = np.arange(10.0) ** 2
    exact = [np.trapezoid(values[i : i + 4]) / 3 for i in (0, 3, 6)]
    assert block_mean(values, 3) == pytest.approx(exact, rel=1e-14)
    assert block_change(values, 3, 0.1) == pytest.approx([30, 90, 150], rel=1e-14)


def test_the_bar_gives_the_torque_that_turned_it(exact):
    """Equation 5 over blocks, against the torque that the simulation recorded."""
    from_channel, from_bar = (torque(exact, from_bar=bar) for bar in (False, True))
    assert np.std(from_bar - from_channel) < 0.02 * np.std(from_channel)


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.203])
def test_a_sine_passes_muscle_and_delay_as_theory_says(delay: float):
    """A display holds what is seen from tick to tick, half a tick of delay more."""
    omega, lags = 6.0, Lags(delay, 30.0, 0.707)
    time = np.arange(5_000) * PERIOD
    signals = Signals({"roll": np.sin(omega * time), "roll_rate": 0 * time}, PERIOD)
    found = columns(signals, ROLL_PD, lags)[:, 0]
    s = 1j * omega
    passed = 30**2 / (s * s + 2 * 0.707 * 30 * s + 30**2) * np.exp(-s * (delay + PERIOD / 2))
    block = block_ticks(PERIOD) * PERIOD
    middle = (np.arange(len(found)) + 0.5) * block
    mean = math.sin(omega * block / 2) / (omega * block / 2)
    expected = mean * np.imag(passed * np.exp(s * middle))
    assert found[100:] == pytest.approx(expected[100:], abs=2e-4)


def test_the_integral_of_steer_begins_at_the_start(exact):
    integral = recorded(exact, structure("schwab2013")).values["steer_integral"]
    assert integral[0] == 0
    assert integral[-1] == pytest.approx(np.trapezoid(exact.steer, dx=PERIOD), abs=1e-12)
