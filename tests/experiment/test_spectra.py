import math

import numpy as np
import pytest
from scipy import signal

from bikesim.experiment.spectra import (
    SEGMENT,
    band_power,
    centroid_frequency,
    line_amplitudes,
    median_frequency,
    welch,
)

TIME = 0.01 * np.arange(6001)


def spectrum_of(values: np.ndarray):
    found = welch(values, 0.01)
    assert found is not None
    return found


def test_welch_is_that_of_scipy():
    values = np.random.default_rng(1).normal(size=6001).cumsum()
    frequency, density = signal.welch(
        values, fs=100, window="hann", nperseg=1024, noverlap=512, detrend="constant"
    )
    found = spectrum_of(values)
    assert np.allclose(found.frequency, frequency)
    assert np.allclose(found.density, density, rtol=1e-9)


def test_the_power_of_a_sine_is_half_its_amplitude_squared():
    found = spectrum_of(3 * np.sin(2 * np.pi * 1.3 * TIME))
    assert band_power(found, 0, math.inf) == pytest.approx(4.5, rel=0.01)
    assert band_power(found, 0.5, 2) == pytest.approx(4.5, rel=0.01)
    assert band_power(found, 2, math.inf) < 0.01


def test_bands_share_out_all_the_power():
    found = spectrum_of(np.random.default_rng(2).normal(size=6001))
    parts = [band_power(found, *band) for band in ((0, 0.5), (0.5, 2), (2, math.inf))]
    assert sum(parts) == pytest.approx(band_power(found, 0, math.inf))


def test_median_and_centroid_of_two_lines():
    """Three quarters of the power at 1 Hz, a quarter at 5 Hz: the centroid is at 2 Hz."""
    values = math.sqrt(3) * np.sin(2 * np.pi * TIME) + np.sin(2 * np.pi * 5 * TIME)
    found = spectrum_of(values)
    assert centroid_frequency(found) == pytest.approx(2.0, rel=0.01)
    assert median_frequency(found) == pytest.approx(1.0, abs=0.1)


def test_median_of_white_noise_is_half_of_the_highest_frequency():
    found = spectrum_of(np.random.default_rng(3).normal(size=60001))
    assert median_frequency(found) == pytest.approx(25.0, abs=0.5)


def test_nothing_has_no_median():
    found = spectrum_of(np.zeros(2000))
    assert math.isnan(median_frequency(found))
    assert math.isnan(centroid_frequency(found))


def test_less_than_a_segment_has_no_spectrum():
    assert welch(np.zeros(round(SEGMENT / 0.01) - 1), 0.01) is None


def test_lines_are_found_in_a_window_of_any_length_with_a_drift():
    frequencies = np.array([0.628, 1.9, 7.3])
    amplitudes = np.array([[1 - 2j, 0.3j, 0.5], [2j, -1, 0.1 + 0.1j]])
    time = TIME[317:5555]
    waves = np.exp(1j * np.outer(frequencies, time))
    signals = np.real(amplitudes @ waves) + 3 + 0.2 * time
    assert np.allclose(line_amplitudes(time, signals, frequencies), amplitudes, atol=1e-8)
