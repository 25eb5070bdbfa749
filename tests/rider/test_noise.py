"""Noise of the senses and of the torque, against its statistics and SciPy."""

import math
from itertools import islice

import numpy as np
import pytest
from scipy.signal import lfilter, welch

from bikesim.rider.noise import coloured_noise, spawned


def values(rms: float, bandwidth: float, step: float, count: int) -> np.ndarray:
    source = coloured_noise(rms, bandwidth, step, np.random.default_rng(3))
    return np.fromiter(source, float, count)


@pytest.mark.parametrize("step", [1e-4, 1e-3, 1e-2])
def test_its_rms_is_as_asked_whatever_the_step(step: float):
    noise = values(0.3, 50.0, step, 400_000)
    # Independent values in it: 400 000 steps over twice the correlation time of 1/50 s.
    independent = 400_000 / max(1, 2 / 50 / step)
    assert noise.std() == pytest.approx(0.3, rel=4 / math.sqrt(2 * independent))


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_its_bandwidth_is_as_asked_whatever_the_step(step: float):
    """Neighbours t apart correlate as exp(-bandwidth t)."""
    noise = values(1.0, 20.0, step, 400_000)
    lag = round(0.05 / step)
    correlation = float(np.mean(noise[lag:] * noise[:-lag]) / np.mean(noise**2))
    assert correlation == pytest.approx(math.exp(-20 * 0.05), abs=0.02)


def test_its_spectrum_is_that_of_a_first_order_lag():
    noise = values(1.0, 20.0, 1e-3, 400_000)
    frequency, density = welch(noise, fs=1000.0, nperseg=4096)
    omega = 2 * math.pi * frequency
    expected = 4 * 20 / (20**2 + omega**2)  # one-sided, in units²/Hz, variance 1
    for low, high in ((0.5, 2), (2, 8), (8, 32)):
        band = (frequency > low) & (frequency < high)
        assert density[band].mean() == pytest.approx(expected[band].mean(), rel=0.1)


def test_it_starts_as_it_goes_on():
    first = [next(coloured_noise(0.3, 1.0, 1e-3, np.random.default_rng(k))) for k in range(2000)]
    assert np.std(first) == pytest.approx(0.3, rel=0.07)


def test_it_is_scipys_filter_of_white_noise():
    step, decay = 1e-3, math.exp(-10 * 1e-3)
    random = np.random.default_rng(7)
    first, white = random.standard_normal(), random.standard_normal(4096)[:999]
    kicks = 0.2 * math.sqrt(1 - decay**2) * white
    theirs = lfilter([1], [1, -decay], [0.2 * first, *kicks])
    ours = list(islice(coloured_noise(0.2, 10.0, step, np.random.default_rng(7)), 1000))
    assert ours == pytest.approx(theirs, abs=1e-14)


def test_none_is_zero():
    assert set(islice(coloured_noise(0.0, 10.0, 1e-3, np.random.default_rng(1)), 100)) == {0.0}


@pytest.mark.parametrize("bandwidth", [5.0, np.array([5.0, 5.0, 200.0])], ids=["one", "each"])
def test_each_of_many_has_what_it_has_alone_to_the_bit(bandwidth):
    """Over the ends of what is drawn at once."""
    rms = np.array([0.1, 0.0, 3.0])
    many = coloured_noise(rms, bandwidth, 1e-3, [np.random.default_rng(k) for k in range(3)])
    together = np.array(list(islice(many, 9000)))
    for k in range(3):
        own = float(bandwidth if isinstance(bandwidth, float) else bandwidth[k])
        alone = coloured_noise(float(rms[k]), own, 1e-3, np.random.default_rng(k))
        assert together[:, k].tolist() == list(islice(alone, 9000))


def test_further_sources_leave_the_first_as_it_was():
    random, same = np.random.default_rng(3), np.random.default_rng(3)
    first, second = spawned(random, 2)
    assert isinstance(first, np.random.Generator)
    assert isinstance(second, np.random.Generator)
    assert first.random() != second.random()
    assert random.random() == same.random()


def test_further_sources_of_many_are_those_of_each():
    many = spawned([np.random.default_rng(k) for k in range(2)], 3)
    each = [spawned(np.random.default_rng(k), 3) for k in range(2)]
    for j in range(3):
        for k in range(2):
            assert many[j][k].random() == each[k][j].random()  # type: ignore[index,union-attr]
