"""The closed loop as a model: what a disturbance alone would make of every signal.

Bicycle and bar are those of eq. 7 [SR13]; the rider has given coefficients and lags. All of it is
computed at frequencies, where a delay is exact, so nothing needs to be stable: of an unstable loop
the bounded (two-sided) answer is given, which is as free of the rider's noise as any.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.identify.ride import Ride, Values
from bikesim.identify.structure import Lags, Structure, Vector
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices

Complex = NDArray[np.complex128]

# What lies below this is taken for it: integrals have no answer at zero [rad/s].
_LOWEST = 1e-6


class Response(NamedTuple):
    """Roll φ and the integral of steer Δ = ∫δ dt at s = jω, from which all signals follow."""

    s: Complex
    roll: Complex
    steer_integral: Complex


def loop_response(
    ride: Ride,
    structure: Structure,
    coefficients: Vector,
    lags: Lags,
    frequency: Values,
    roll_moment: NDArray[Any],
    bar_torque: NDArray[Any],
) -> Response:
    """The answer at `frequency` ω [rad/s] to a roll moment and a torque on the bar [N m].

    They are complex amplitudes there. The torque on the bar comes on top of the rider's.
    """
    s = 1j * np.maximum(frequency, _LOWEST)
    mass, damping, stiffness = simulator_matrices(ride.bicycle, ride.law, ride.speed, ride.inertia)
    dynamic = [
        [s * s * mass[i, j] + s * damping[i, j] + stiffness[i, j] for j in (0, 1)] for i in (0, 1)
    ]
    # In (φ, Δ): δ = s Δ.
    upper_roll, upper_steer = dynamic[0][0], s * dynamic[0][1]
    held = ride.passive
    lower_roll = dynamic[1][0]
    lower_steer = s * (dynamic[1][1] + s * s * held.inertia + s * held.damping + held.stiffness)
    filters = term_filters(structure, lags, s)
    for coefficient, term, passed in zip(coefficients, structure.terms, filters, strict=True):
        of_roll, of_steer = _rows(term.signal, ride, s)
        lower_roll = lower_roll - coefficient * passed * of_roll
        lower_steer = lower_steer - coefficient * passed * of_steer
    determinant = upper_roll * lower_steer - upper_steer * lower_roll
    return Response(
        s,
        (lower_steer * roll_moment - upper_steer * bar_torque) / determinant,
        (upper_roll * bar_torque - lower_roll * roll_moment) / determinant,
    )


def modelled_torque(
    ride: Ride, structure: Structure, coefficients: Vector, lags: Lags, response: Response
) -> Complex:
    """The rider's torque in a response [N m]."""
    torque = np.zeros_like(response.roll)
    filters = term_filters(structure, lags, response.s)
    for coefficient, term, passed in zip(coefficients, structure.terms, filters, strict=True):
        torque += coefficient * passed * signal_of(term.signal, ride, response)
    return torque


def signal_of(name: str, ride: Ride, response: Response) -> Complex:
    """A signal by name, in a response."""
    of_roll, of_steer = _rows(name, ride, response.s)
    return of_roll * response.roll + of_steer * response.steer_integral


def term_filters(structure: Structure, lags: Lags, s: Complex) -> list[Complex]:
    """What each term's signal passes on its way to torque, at s."""
    omega, zeta = lags.muscle_frequency, lags.muscle_damping_ratio
    felt = omega**2 / (s * s + 2 * zeta * omega * s + omega**2)
    ways = {"hands": felt, "eyes": felt * np.exp(-s * lags.delay), "arms": np.ones_like(s)}
    return [ways[term.through] for term in structure.terms]


def simulated(
    ride: Ride, structure: Structure, coefficients: Vector, lags: Lags
) -> dict[str, Values]:
    """The signals of the structure's terms as the ride's disturbance alone would move them."""
    from scipy.fft import irfft, next_fast_len, rfft

    ticks = len(ride.roll)
    size = next_fast_len(ticks + round(_MEMORY / ride.period), real=True)
    frequency = 2 * np.pi * np.fft.rfftfreq(size, ride.period)
    answer = loop_response(
        ride,
        structure,
        coefficients,
        lags,
        frequency,
        rfft(ride.roll_moment, size),
        rfft(felt_moment(ride), size),
    )
    names = {_SAMPLED.get(term.signal, term.signal) for term in structure.terms}
    return {name: irfft(signal_of(name, ride, answer), size)[:ticks] for name in names}


def felt_moment(ride: Ride) -> Values:
    """The disturbance T_δ as it comes to the bar: with the feedback torque, or not at all."""
    return 0 * ride.steer_moment if ride.law is Law.OFF else ride.steer_moment


# The answer to the end of a run that may come round to its beginning [s].
_MEMORY = 20.0
# The acceleration is taken from the rate, as it is for a record.
_SAMPLED = {"steer_acceleration": "steer_rate"}


def _rows(name: str, ride: Ride, s: Complex) -> tuple[Complex, Complex]:
    """A signal as multiples of φ and Δ; the path by eq. 8 for small angles, y_q as in [H12]."""
    none, one = np.zeros_like(s), np.ones_like(s)
    if name == "roll":
        return one, none
    if name == "roll_rate":
        return s, none
    powers = {"steer_integral": 0, "steer": 1, "steer_rate": 2, "steer_acceleration": 3}
    if name in powers:
        return none, s ** powers[name]
    bicycle = ride.bicycle
    cosine = np.cos(bicycle.steer_axis_tilt)
    heading = (ride.speed + bicycle.trail * s) * cosine / bicycle.wheelbase
    if name == "heading":
        return none, heading
    return none, (ride.speed / s + bicycle.wheelbase) * heading - bicycle.trail * cosine * s
