"""Spectra of a run's signals: power over frequency, and amplitudes at known lines."""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

SEGMENT = 10.24
"""Length of a segment of Welch's method [s]: resolves 0.1 Hz."""

Reals = NDArray[np.floating[Any]]
Complexes = NDArray[np.complex128]


class Spectrum(NamedTuple):
    """One-sided power density [unit²/Hz] at frequencies [Hz]; both (n,)."""

    frequency: Reals
    density: Reals


def welch(values: Reals, period: float) -> Spectrum | None:
    """Welch's periodogram: Hann segments of SEGMENT that overlap by half, each less its mean.

    `values` (m,), `period` [s] apart. None for less than a segment. [Welch 1967]
    """
    length = round(SEGMENT / period)
    if len(values) < length or length < 2:
        return None
    segments = np.lib.stride_tricks.sliding_window_view(values, length)[:: length // 2]
    segments = segments - segments.mean(axis=1, keepdims=True)
    window = _hann(length)
    power = np.square(np.abs(np.fft.rfft(segments * window, axis=1))).mean(axis=0)
    power *= 2 * period / (window @ window)
    power[0] /= 2
    if length % 2 == 0:
        power[-1] /= 2
    return Spectrum(np.fft.rfftfreq(length, period), power)


def band_power(spectrum: Spectrum, low: float, high: float) -> float:
    """The power [unit²] between two frequencies [Hz], the lower included."""
    step = float(spectrum.frequency[1])
    inside = (spectrum.frequency >= low) & (spectrum.frequency < high)
    return float(spectrum.density[inside].sum() * step)


def median_frequency(spectrum: Spectrum) -> float:
    """The frequency [Hz] with half of the power below it; NaN without power."""
    # The power of a line lies around it, so half of its own is below it.
    total = np.cumsum(spectrum.density) - 0.5 * spectrum.density
    if not spectrum.density.sum() > 0:
        return math.nan
    return float(np.interp(0.5 * spectrum.density.sum(), total, spectrum.frequency))


def centroid_frequency(spectrum: Spectrum) -> float:
    """The mean of the frequencies [Hz], each weighed with its power; NaN without power."""
    power = float(spectrum.density.sum())
    return float(spectrum.frequency @ spectrum.density) / power if power > 0 else math.nan


def line_amplitudes(time: Reals, signals: Reals, frequencies: Reals) -> Complexes:
    """Amplitudes X (k, n) with x(t) ≈ a + b t + Σ Re X_i e^{jω_i t}, by least squares.

    `time` (m,) [s], `signals` (k, m), `frequencies` ω (n,) [rad/s]. A window that is no whole
    number of periods does no harm, since the lines are fitted together.
    """
    fit = _fit(float(time[0]), float(time[-1]), len(time), tuple(frequencies.tolist()))
    fitted = signals @ fit
    n = len(frequencies)
    return fitted[:, 2 : 2 + n] - 1j * fitted[:, 2 + n :]


@lru_cache(maxsize=8)
def _fit(first: float, last: float, count: int, frequencies: tuple[float, ...]) -> Reals:
    """From samples to coefficients, (m, 2 + 2 n): the same for all runs of equal length."""
    time = np.linspace(first, last, count)
    angles = np.outer(time, frequencies)
    trend = (time - time.mean()) / max(last - first, 1e-300)
    basis = np.column_stack([np.ones(count), trend, np.cos(angles), np.sin(angles)])
    return np.linalg.solve(basis.T @ basis, basis.T).T.copy()


@lru_cache(maxsize=8)
def _hann(length: int) -> Reals:
    return 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
