"""At which frequencies a known disturbance excites the rider."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.identify.regressors import block_mean, block_ticks, settled
from bikesim.identify.ride import Ride
from bikesim.identify.structure import Vector

HIGHEST = 10.0
"""Highest frequency that counts [Hz]: no rider follows beyond it."""

# Of the strongest frequency's power; the window's side lobes are below it.
_SHARE = 0.01
_LINE = 5  # bins: a line is as wide as the window's main lobe
_BANDS = 12  # a decade, of a disturbance that is no sum of lines


class Band(NamedTuple):
    """Bins of one line or of a band of a wide spectrum; the one with the most power.

    `frequency` [rad/s]: of a line its own, between two bins; else that of the peak.
    """

    bins: NDArray[np.intp]
    peak: int
    line: bool
    frequency: float


class Excitation(NamedTuple):
    """Spectra of rides of equal length: frequency (n,) [rad/s], disturbance (rides, n), bands."""

    frequency: Vector
    disturbance: NDArray[np.complex128]
    bands: tuple[Band, ...]

    @property
    def lines(self) -> int:
        """How many frequencies are excited."""
        return len(self.bands)


def excitation(rides: Sequence[Ride]) -> Excitation:
    """Of the roll moment, or of the steer moment where there is no other."""
    blocks = shortest(rides)
    roll = any(ride.roll_moment.any() for ride in rides)
    moments = [ride.roll_moment if roll else ride.steer_moment for ride in rides]
    spectra = spectrum(
        [
            block_mean(moment, block_ticks(ride.period))[settled(ride) :][:blocks]
            for ride, moment in zip(rides, moments, strict=True)
        ]
    )
    interval = block_ticks(rides[0].period) * rides[0].period
    frequency = np.fft.rfftfreq(blocks, interval)
    power = np.sum(np.abs(spectra) ** 2, axis=0) * (frequency <= HIGHEST)
    power[:2] = 0
    excited = power > _SHARE * max(power.max(), 1e-300)
    bands = _bands(excited, power, 2 * np.pi * frequency[1])
    return Excitation(2 * np.pi * frequency, spectra, tuple(bands))


def shortest(rides: Sequence[Ride]) -> int:
    """Blocks after settling of the shortest ride."""
    return min((len(r.roll) - 1) // block_ticks(r.period) - settled(r) for r in rides)


def spectrum(signals: Sequence[Vector]) -> NDArray[np.complex128]:
    """Of each signal less its mean, through Hann's window: (signals, bins)."""
    values = np.array(signals)
    values = values - values.mean(axis=1, keepdims=True)
    return np.fft.rfft(values * np.hanning(values.shape[1]), axis=1)


def _bands(excited: NDArray[np.bool_], power: Vector, width: float) -> list[Band]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], excited, [False]]).astype(int)))
    pieces = [
        piece
        for first, end in edges.reshape(-1, 2).tolist()
        for piece in pairwise([first, *_dips(first, end, power), end])
    ]
    return [
        _band(bins, stop - start <= _LINE, power, width)
        for start, stop in pieces
        for bins in ([np.arange(start, stop)] if stop - start <= _LINE else _split(start, stop))
    ]


def _band(bins: NDArray[np.intp], line: bool, power: Vector, width: float) -> Band:
    """`width` [rad/s] of a bin."""
    peak = int(bins[power[bins].argmax()])
    if not line:
        return Band(bins, peak, line, width * peak)
    # Of Hann's window, the ratio of the two highest bins says where between them a line is.
    beside = max((peak - 1, peak + 1), key=lambda i: power[i])
    ratio = np.sqrt(power[beside] / power[peak])
    shift = (beside - peak) * (2 * ratio - 1) / (ratio + 1)
    return Band(bins, peak, line, width * (peak + float(shift)))


def _dips(first: int, end: int, power: Vector) -> list[int]:
    """Where the power dips between lines that stand close together."""
    own = power[first:end]
    return [
        first + i
        for i in range(1, len(own) - 1)
        if own[i] < own[i - 1] and own[i] <= own[i + 1] and own[i] < 0.5 * own[: i + 1].max()
    ]


def _split(first: int, end: int) -> list[NDArray[np.intp]]:
    """Bands of equal width on a logarithmic scale, each of at least a line's bins."""
    pieces, start = [], first
    while start < end:
        stop = max(start + _LINE, int(start * 10 ** (1 / _BANDS)))
        stop = end if end - stop < _LINE else stop
        pieces.append(np.arange(start, stop))
        start = stop
    return pieces
