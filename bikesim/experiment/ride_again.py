"""A record ridden again: the same loop and law, on a rig that plays back its recorded steer."""

import math
from typing import NamedTuple

import numpy as np

from bikesim.errors import InputError
from bikesim.guard import Guard, GuardSettings
from bikesim.loop import Moments, Start, ride
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.reader import Run
from bikesim.rig.base import RigInfo, Sample
from bikesim.rig.playback import PlaybackRig
from bikesim.textfile import parse_toml


class Difference(NamedTuple):
    """The ticks ridden again, and the largest differences from the record over them [N m].

    Of T_f as the law gives it, and of what the guard allows.
    """

    ticks: int
    feedback_torque: float
    allowed_torque: float


class _RecordedCourse:
    """Speed and disturbance as recorded, found by the tick's own time."""

    def __init__(self, run: Run) -> None:
        time = run.time.tolist()
        pushes = zip(
            run.channel("roll_moment").tolist(), run.channel("steer_moment").tolist(), strict=True
        )
        self._speed = dict(zip(time, run.channel("speed").tolist(), strict=True))
        self._disturbance = dict(zip(time, (Moments(*push) for push in pushes), strict=True))

    def speed(self, time: float) -> float:
        """[m/s]"""
        return self._speed[time]

    def disturbance(self, time: float) -> Moments:
        """[N m]"""
        return self._disturbance[time]


class _Rows:
    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)

    def column(self, name: str) -> np.ndarray:
        names = [channel.name for channel in TICK_CHANNELS]
        return np.array([row[names.index(name)] for row in self.rows])


def ride_again(run: Run) -> Difference:
    """Both differences are zero where law and guard compute today what they did then."""
    steer_stop, limits = _limits(run)
    columns = (run.channel(name).tolist() for name in ("time", "steer", "steer_rate"))
    samples = [Sample(*values) for values in zip(*columns, strict=True)]
    info = RigInfo("playback", run.period, run.handlebar_inertia, steer_stop)
    rows = _Rows()
    ride(
        PlaybackRig(info, samples),
        HapticBicycle(run.bicycle, Law(run.law)),
        Guard(limits, run.period, info.steer_stop),
        rows,
        course=_RecordedCourse(run),
        start=Start(*(float(run.channel(name)[0]) for name in ("roll", "roll_rate", "heading"))),
        ticks=run.ticks + 1,
    )
    return Difference(
        len(rows.rows),
        _largest(run, rows, "feedback_torque"),
        _largest(run, rows, "allowed_torque"),
    )


def _limits(run: Run) -> tuple[float, GuardSettings]:
    """The steer stop [rad] and the guard; not more, as a scenario may name files now gone."""
    try:
        scenario = parse_toml(run.scenario)
        stop = math.radians(scenario["rig"]["steer_stop_deg"])
        return stop, GuardSettings(**scenario["guard"])
    except KeyError as error:
        raise InputError(f"{run.path}: its scenario is damaged: {error} is missing") from None
    except (InputError, TypeError) as error:
        raise InputError(f"{run.path}: its scenario is damaged: {error}") from None


def _largest(run: Run, rows: _Rows, name: str) -> float:
    again = rows.column(name)
    return float(np.abs(again - run.channel(name)[: len(again)]).max())
