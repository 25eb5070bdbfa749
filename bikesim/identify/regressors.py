"""A record as a regression: the torque's mean over each short block, and that of each term."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.identify.ride import Ride, Values
from bikesim.identify.structure import Lags, Structure, Vector
from bikesim.model.transition import transition

Columns = NDArray[np.floating[Any]]

BLOCK = 0.02
"""Length of a block [s]: a quarter of the shortest neuromuscular lag, and more than the ticks'."""
SETTLING = 2.0
"""Left out at the start [s]: what was before the record is forgotten by then."""


class Signals(NamedTuple):
    """What enters a rider, by name, a value a tick: as recorded, or as simulated."""

    values: dict[str, Values]
    period: float


def recorded(ride: Ride, structure: Structure) -> Signals:
    """The signals of the structure's terms in a record. Raises InputError where one is missing."""
    values: dict[str, Values] = {
        "roll": ride.roll,
        "roll_rate": ride.roll_rate,
        "steer": ride.steer,
        "steer_rate": ride.steer_rate,
        "steer_integral": _integral(ride.steer, ride.period),
    }
    wanted = {term.signal for term in structure.terms}
    for name, channel in (("heading", ride.heading), ("front_y", ride.y)):
        if name not in wanted:
            continue
        if channel is None or ride.heading is None:
            what = "heading" if ride.heading is None else "y"
            raise InputError(f"{ride.name}: has no {what}; structure {structure.name} needs it")
        values[name] = channel
    if "front_y" in wanted:
        values["front_y"] = _front(ride)
    return Signals(values, ride.period)


def columns(signals: Signals, structure: Structure, lags: Lags) -> Columns:
    """The mean of each term's signal over each block, after what it passes: (blocks, terms).

    What is seen is held from tick to tick, as a display does; what is felt goes on between them.
    """
    every = block_ticks(signals.period)
    found = []
    for signal, through in structure.terms:
        if signal == "steer_acceleration":
            found.append(block_change(signals.values["steer_rate"], every, signals.period))
            continue
        values = signals.values[signal]
        if through != "arms":
            values = _muscle(values, lags, signals.period, held=through == "eyes")
        if through == "eyes" and lags.delay:
            values = _late(values, lags.delay, signals.period)
        found.append(block_mean(values, every))
    return np.column_stack(found)


def torque(ride: Ride, *, from_bar: bool) -> Vector:
    """The mean of the rider's torque over each block [N m].

    `from_bar`: by eq. 5, T_δ = I δ̈ - T_f, whose mean over a block needs no acceleration: only the
    rate at its two ends. Arms are then in it. Otherwise as the record's channel says.
    """
    if from_bar:
        return bar_torque(ride.steer_rate, ride.motor_torque, ride.inertia, ride.period)
    assert ride.rider_torque is not None
    return block_mean(ride.rider_torque, block_ticks(ride.period))


def bar_torque(steer_rate: Values, motor_torque: Values, inertia: float, period: float) -> Vector:
    """The mean of I δ̈ - T_f over each block [N m], with T_f held from tick to tick."""
    every = block_ticks(period)
    held = motor_torque[: (len(steer_rate) - 1) // every * every]
    return inertia * block_change(steer_rate, every, period) - held.reshape(-1, every).mean(axis=1)


def settled(ride: Ride) -> int:
    """How many blocks at the start are left out."""
    return round(SETTLING / (block_ticks(ride.period) * ride.period))


def block_ticks(period: float) -> int:
    """Ticks of a block, for a loop period [s]."""
    return max(1, round(BLOCK / period))


def block_mean(values: Values, every: int) -> Vector:
    """By the trapezium; a block begins and ends at a tick."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))])
    return np.diff(area[::every]) / every


def block_change(values: Values, every: int, period: float) -> Vector:
    """The mean of the derivative [1/s]."""
    return np.diff(values[::every]) / (every * period)


def _integral(values: Values, period: float) -> Values:
    return np.concatenate([[0.0], np.cumsum(0.5 * period * (values[1:] + values[:-1]))])


def _front(ride: Ride) -> Values:
    """y_q = y_p + w ψ - c δ cos λ of the front contact [m], small angles [H12]."""
    assert ride.y is not None
    assert ride.heading is not None
    bicycle = ride.bicycle
    trail = bicycle.trail * np.cos(bicycle.steer_axis_tilt)
    return ride.y + bicycle.wheelbase * ride.heading - trail * ride.steer


def _muscle(values: Values, lags: Lags, period: float, *, held: bool) -> Values:
    """Through G_nm, at rest at the first value; exact for what is held, or linear, between ticks.

    x' = P x + a u + b u' for its state x from tick to tick, written as a ratio of polynomials.
    """
    from scipy.signal import lfilter

    omega, zeta = lags.muscle_frequency, lags.muscle_damping_ratio
    stiffness, damping = omega**2, 2 * zeta * omega
    p11, p12, p21, p22, _, a1, _, a2, _, b1, _, b2 = transition(period, stiffness, damping)
    if held:
        a1, a2, b1, b2 = a1 + b1, a2 + b2, 0.0, 0.0
    over = [b1, a1 - p22 * b1 + p12 * b2, p12 * a2 - p22 * a1]
    under = [1.0, -(p11 + p22), p11 * p22 - p12 * p21]
    return values[0] + stiffness * lfilter(over, under, values - values[0])


def _late(values: Values, delay: float, period: float) -> Values:
    ticks = np.arange(len(values), dtype=float)
    return np.interp(ticks - delay / period, ticks, values)
