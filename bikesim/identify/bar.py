"""The torque that a rider gave in a record that did not measure it: by the motion of the bar."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from bikesim.errors import InputError
from bikesim.identify.reading import even_clock, first_of, motor_torque, on_clock
from bikesim.identify.regressors import bar_torque, block_ticks
from bikesim.identify.ride import Values
from bikesim.record.reader import Run, open_run
from bikesim.record.recording import is_csv, read_recording


class BarTorque(NamedTuple):
    """Torque [N m], > 0 to the right, by the time [s] since the record's first tick; both (n,)."""

    time: Values
    torque: Values


class _Bar(NamedTuple):
    """What eq. 5 needs of a record, a value a tick."""

    time: Values
    period: float
    inertia: float
    steer_rate: Values
    motor_torque: Values


def read_bar_torque(path: Path, inertia: float | None = None) -> BarTorque:
    """The rider's torque by eq. 5, T_δ = I δ̈ - T_f, as means over blocks of 20 ms, in their middle.

    The first and the last also stand at the record's ends. The whole record is used, the fall too;
    arms and the rig's friction are in it. `inertia` I_δ [kg m²] replaces that of the record; a CSV
    of another rig has none. Raises InputError.
    """
    bar = _of_csv(path, inertia) if is_csv(path) else _of_run(open_run(path), inertia)
    if len(bar.time) < 2:
        raise InputError(f"{path}: {len(bar.time)} ticks are recorded in it: too few")
    even = even_clock(str(path), bar.time, bar.period)
    rate, motor = (on_clock(even, bar.time, each) for each in (bar.steer_rate, bar.motor_torque))
    every = block_ticks(bar.period)
    if len(rate) <= every:
        raise InputError(f"{path}: {len(rate)} ticks are no block of 20 ms: too few")
    torque = bar_torque(rate, motor, bar.inertia, bar.period)
    if not np.isfinite(torque).all():
        at = int(np.argmin(np.isfinite(torque))) * every * bar.period
        raise InputError(f"{path}: steer_rate or feedback torque is no number after {at:.6g} s")
    middle = (np.arange(len(torque)) + 0.5) * every * bar.period
    last = (len(rate) - 1) * bar.period
    return BarTorque(
        np.concatenate([[0.0], middle, [last]]),
        np.concatenate([torque[:1], torque, torque[-1:]]),
    )


def _of_csv(path: Path, inertia: float | None) -> _Bar:
    if inertia is None:
        raise InputError(f"{path}: a CSV does not say its handlebar's inertia; give one")
    found = read_recording(path)
    period = round(float(np.median(np.diff(found.time))), 9) if len(found.time) > 1 else 1.0
    return _Bar(found.time, period, inertia, found.steer_rate, found.torque)


def _of_run(run: Run, inertia: float | None) -> _Bar:
    rate = first_of(run, "true_steer_rate", "steer_rate")
    known = run.handlebar_inertia if inertia is None else inertia
    return _Bar(run.time, run.period, known, rate, motor_torque(run))
