"""Rides from records of ours and from recordings of other rigs."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bikesim.errors import InputError
from bikesim.identify.ride import Passive, Ride, Values
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.record.reader import Run
from bikesim.record.recording import read_recording
from bikesim.textfile import parse_toml

# Beyond this roll a bicycle has fallen [rad]; what a rider does just before is no steady control.
_FALLEN = math.pi / 4
_BEFORE_FALL = 1.0  # [s]
# A clock that is further from an even one than this part of a period is put on an even one.
_JITTER = 1e-6
_GAP = 20  # periods without a sample that are too many to bridge
_NEEDED = (
    "roll", "roll_rate", "steer", "steer_rate", "speed", "sent_torque", "roll_moment",
    "steer_moment",
)  # fmt: skip


def of_run(run: Run, bicycle: Bicycle | None, inertia: float | None, law: Law | None) -> Ride:
    """A ride of a record. Raises InputError."""
    if run.ticks < 2:
        raise InputError(f"{run.path}: {run.ticks} ticks are recorded in it: too few")
    if missing := [name for name in ("time", *_NEEDED) if name not in run.names]:
        raise InputError(f"{run.path}: channel {missing[0]} is missing; identification needs it")
    scenario = _scenario(run)
    ending = run.ending
    # What the rider felt, where the record has it: the rig's sensors add noise and lag of theirs.
    steer = first_of(run, "true_steer", "steer")
    columns = {
        "roll": run.channel("roll"),
        "roll_rate": run.channel("roll_rate"),
        "steer": steer,
        "steer_rate": first_of(run, "true_steer_rate", "steer_rate"),
        "motor_torque": motor_torque(run),
        "roll_moment": run.channel("roll_moment"),
        "steer_moment": run.channel("steer_moment"),
        "heading": run.channel("heading") if "heading" in run.names else None,
        "y": run.channel("y") if "y" in run.names else None,
        "rider_torque": run.channel("rider_torque") if "rider_torque" in run.names else None,
    }
    return _ride(
        str(run.path),
        run.time,
        run.period,
        run.channel("speed"),
        columns,
        bicycle=bicycle or run.bicycle,
        law=law or Law(run.law),
        inertia=inertia or run.handlebar_inertia,
        rider=run.rider,
        fell=ending.fall_time if ending is not None and ending.fell else None,
        passive=_arms(scenario),
        straight=_is_straight(scenario),
    )


def of_recording(path: Path, bicycle: Bicycle | None, inertia: float | None, law: Law) -> Ride:
    """A ride of another rig's CSV, which knows neither its bicycle nor its handlebar."""
    recording = read_recording(path)
    if bicycle is None:
        raise InputError(f"{path}: a CSV does not say whose bicycle it is; give --bicycle")
    if inertia is None:
        raise InputError(f"{path}: a CSV does not say its handlebar's inertia; give --inertia")
    columns = {
        "roll": recording.roll,
        "roll_rate": recording.roll_rate,
        "steer": recording.steer,
        "steer_rate": recording.steer_rate,
        "motor_torque": recording.torque,
        "roll_moment": recording.roll_moment,
        "steer_moment": recording.steer_moment,
    }
    if len(recording.time) < 2:
        raise InputError(f"{path}: a single row is no ride")
    period = round(float(np.median(np.diff(recording.time))), 9)
    return _ride(
        str(path),
        recording.time,
        period,
        recording.speed,
        columns,
        bicycle=bicycle,
        law=law,
        inertia=inertia,
        rider=None,
        fell=None,
    )


def _ride(
    name: str,
    time: Values,
    period: float,
    speed: Values,
    columns: Mapping[str, Values | None],
    *,
    fell: float | None,
    **about: Any,
) -> Ride:
    """Cut off before the fall, and put on an even clock."""
    roll = columns["roll"]
    assert roll is not None
    fallen = np.abs(roll) > _FALLEN
    if fell is None and fallen.any():
        fell = float(time[fallen.argmax()] - time[0])
    until = len(time) if fell is None else int(np.searchsorted(time, time[0] + fell - _BEFORE_FALL))
    if until < 2:
        raise InputError(f"{name}: fell at {fell:.2f} s: nothing before it to identify from")
    even = even_clock(name, time[:until], period)
    return Ride(
        name=name,
        period=period,
        fell=fell,
        speed=float(np.mean(speed[:until])),
        speed_range=float(np.ptp(speed[:until])),
        **{
            key: None if values is None else on_clock(even, time[:until], values[:until])
            for key, values in columns.items()
        },
        **about,
    )


def even_clock(name: str, time: Values, period: float) -> Values | None:
    """Evenly spaced times [s], None where the ticks are so already."""
    steps = np.diff(time)
    if steps.max() > _GAP * period:
        at = float(time[steps.argmax()])
        raise InputError(
            f"{name}: {steps.max():.3g} s without a sample after {at:.6g} s: too long a gap"
        )
    even = time[0] + period * np.arange(round((time[-1] - time[0]) / period) + 1)
    if len(even) == len(time) and np.abs(even - time).max() <= _JITTER * period:
        return None
    return even


def on_clock(even: Values | None, time: Values, values: Values) -> Values:
    """Values at `time` put on evenly spaced times by lines; as they are where `even` is None."""
    return values if even is None else np.interp(even, time, values)


def first_of(run: Run, *names: str) -> Values:
    """The first of these channels that a record has. Raises InputError for none of them."""
    return run.channel(next((name for name in names if name in run.names), names[-1]))


def motor_torque(run: Run) -> Values:
    """What acts from each tick on: the motor's own torque is recorded when the step is over."""
    if "motor_torque" not in run.names:
        return run.channel("sent_torque")
    acted = run.channel("motor_torque")
    return np.append(acted[1:], acted[-1])


def _scenario(run: Run) -> dict[str, Any]:
    """Empty for a record without one: what a bench writes need be no scenario of ours."""
    try:
        return parse_toml(run.scenario)
    except InputError:
        return {}


def _arms(scenario: dict[str, Any]) -> Passive:
    rider = scenario.get("rider")
    rider = rider if isinstance(rider, dict) else {}
    figures = (rider.get(f"arm_{name}", 0.0) for name in ("inertia", "damping", "stiffness"))
    return Passive(*(float(figure) for figure in figures if isinstance(figure, int | float)))


def _is_straight(scenario: dict[str, Any]) -> bool:
    path = scenario.get("path", "straight")
    return (path.get("kind", "straight") if isinstance(path, dict) else path) == "straight"
