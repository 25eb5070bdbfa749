"""How fast a rider controls roll, and with what margin: from a run with a known disturbance."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]


class Margins(NamedTuple):
    """Of an open loop L: ω_c [rad/s] where |L| falls through 1, and π + arg L(jω_c) [rad]."""

    crossover_frequency: float
    phase_margin: float


def loop_of_roll_disturbance(torque: Complexes, roll: Complexes, plant: Complexes) -> Complexes:
    """L = -(S_dT/S_dφ) φ/T_δ: the describing function of roll to rider torque, and the plant.

    `torque`, `roll` (n,) are amplitudes at the lines of a roll disturbance d, which is the
    instrument: noise that does not go with d drops out. Exact for a rider who acts on roll alone;
    of one who also acts on steer or path it is the rider as seen from roll.
    """
    return -(torque / roll) * plant


def loop_of_steer_disturbance(torque: Complexes, disturbance: Complexes) -> Complexes:
    """L = -H/(1+H) with H = S_dT/S_dd, of a steer disturbance d where the rider's torque acts.

    Exact for any linear rider: T_δ = -L (T_δ + d).
    """
    closed = torque / disturbance
    return -closed / (1 + closed)


def margins(frequencies: Reals, loop: Complexes) -> Margins:
    """Where |L| last falls through 1 between lines, log-linear in ω; NaN where it does not.

    `frequencies` (n,) rise [rad/s]; `loop` (n,). A negative margin is that of an unstable loop.
    """
    gain = np.log(np.abs(loop))
    falls = np.flatnonzero((gain[:-1] >= 0) & (gain[1:] < 0))
    if not falls.size or not np.all(np.isfinite(gain)):
        return Margins(math.nan, math.nan)
    i = int(falls[-1])
    part = gain[i] / (gain[i] - gain[i + 1])
    log = np.log(frequencies[i : i + 2])
    turned = np.angle(loop[i + 1] / loop[i])
    phase = np.angle(loop[i]) + part * turned
    margin = math.remainder(phase + math.pi, 2 * math.pi)
    return Margins(float(np.exp(log[0] + part * (log[1] - log[0]))), margin)


def delay_response(frequencies: Reals, delay: float, lag: float = 0.0) -> Complexes:
    """e^{-jωτ}/(1 + jω lag) (n,), of a dead time and a first-order lag [s]."""
    return np.exp(-1j * frequencies * delay) / (1 + 1j * frequencies * lag)


def butterworth_response(frequencies: Reals, cutoff: float | None, order: int = 2) -> Complexes:
    """A Butterworth low pass of -3 dB at `cutoff` [rad/s], (n,); None: no filter."""
    if cutoff is None:
        return np.ones(len(frequencies), complex)
    s = 1j * frequencies / cutoff
    poles: Sequence[complex] = [
        np.exp(1j * math.pi * (2 * k + order + 1) / (2 * order)) for k in range(order)
    ]
    return np.prod([1 / (s / -pole + 1) for pole in poles], axis=0)
