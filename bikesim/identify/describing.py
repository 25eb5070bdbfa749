"""The rider's describing function from roll to torque, measured where he is excited and modelled.

Y(jω) = S_dT / S_dφ, the cross spectra with the known disturbance d [McRuer & Jex 1967]: the joint
input-output method, which the remnant does not bias. It is the whole of what the rider does at a
frequency, steer feedback included, for a rider on this bicycle.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.identify.estimate import Parameters
from bikesim.identify.excitation import Band, Excitation, shortest, spectrum
from bikesim.identify.loop import felt_moment, loop_response, modelled_torque
from bikesim.identify.regressors import block_mean, block_ticks, settled, torque
from bikesim.identify.ride import Ride
from bikesim.identify.structure import Structure, Vector

Complex = NDArray[np.complex128]

_FINE = 200  # points of the modelled curve
_WINDOW = 1.5  # bins of Hann's window that make one independent value
_AROUND = 12  # bins on each side over which the noise is averaged


class DescribingFunction(NamedTuple):
    """Y [N m/rad] at excited frequencies ω [rad/s], with the standard error of each of its parts.

    `model` is that of the identified rider, over `model_frequency`.
    """

    frequency: Vector
    measured: Complex
    standard_error: Vector
    model_frequency: Vector
    model: Complex


class Identified(NamedTuple):
    """The rider whose describing function it is, and what he leaves of each ride's torque [N m].

    `from_bar`: whether the torque was computed from the bar.
    """

    structure: Structure
    parameters: Parameters
    residual: Sequence[Vector]
    from_bar: bool


def describing_function(
    rides: Sequence[Ride], found: Excitation, rider: Identified
) -> DescribingFunction:
    """Of rides whose excitation is known; at least one frequency must be excited."""
    blocks = shortest(rides)
    roll = spectrum(
        [
            block_mean(ride.roll, block_ticks(ride.period))[settled(ride) :][:blocks]
            for ride in rides
        ]
    )
    given = spectrum([torque(r, from_bar=rider.from_bar)[settled(r) :][:blocks] for r in rides])
    noise = np.mean(np.abs(spectrum([e[:blocks] for e in rider.residual])) ** 2, axis=0)
    frequency = np.array([band.frequency for band in found.bands])
    points = [_measured(band, found.disturbance, roll, given) for band in found.bands]
    measured = np.array([value for value, _ in points])
    density = np.array([noise[_near(band.peak, len(noise))].mean() for band in found.bands])
    spread = np.array([factor for _, factor in points]) * density
    error = np.sqrt(spread / 2) * np.abs(_through(rides[0], rider, frequency, measured))
    fine = np.geomspace(frequency[0] / 1.2, frequency[-1] * 1.2, _FINE)
    return DescribingFunction(frequency, measured, error, fine, _modelled(rides[0], rider, fine))


def _measured(
    band: Band, disturbance: Complex, roll: Complex, given: Complex
) -> tuple[complex, float]:
    """Y, and by what the power of the noise in T - Y φ is to be multiplied for its variance."""
    bins = np.array([band.peak]) if band.line else band.bins
    d, phi, torque_ = (values[:, bins] for values in (disturbance, roll, given))
    common = np.sum(phi * d.conj())
    factor = np.sum(np.abs(d) ** 2) / np.abs(common) ** 2
    value = np.sum(torque_ * d.conj()) / common
    return complex(value), float(factor if band.line else _WINDOW * factor)


def _near(peak: int, bins: int) -> slice:
    """The remnant has no lines, so that those of the disturbance need not be left out."""
    return slice(max(peak - _AROUND, 1), min(peak + _AROUND + 1, bins))


def _through(ride: Ride, rider: Identified, frequency: Vector, measured: Complex) -> Complex:
    """What a remnant of 1 N m makes of T - Y φ, round the loop."""
    one = np.ones(len(frequency), complex)
    s, p = rider.structure, rider.parameters
    answer = loop_response(ride, s, p.coefficients, p.lags, frequency, 0 * one, one)
    given = one + modelled_torque(ride, s, p.coefficients, p.lags, answer)
    return given - measured * answer.roll


def _modelled(ride: Ride, rider: Identified, frequency: Vector) -> Complex:
    roll, steer = ride.roll_moment, felt_moment(ride)
    one = np.ones(len(frequency), complex)
    # A push or the wind acts on both coordinates at once, always in the same proportion.
    share = float(steer @ roll / (roll @ roll)) if roll.any() else 1.0
    pushed = (one if roll.any() else 0 * one, share * one)
    s, p = rider.structure, rider.parameters
    answer = loop_response(ride, s, p.coefficients, p.lags, frequency, *pushed)
    return modelled_torque(ride, s, p.coefficients, p.lags, answer) / answer.roll
