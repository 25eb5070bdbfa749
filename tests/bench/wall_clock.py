"""Rides of a host process on the wall clock, and how they must have ended.

The thresholds have room for a computer that has no time for some tens of milliseconds, and ramping
out (R2) takes so long that nobody can take it for zero at once (R3).
"""

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim.bench.mishaps import Mishap

from .hosts import AT, Host, Ridden, ridden
from .processes import WATCHDOG, written

RAMP_OUT = 0.5  # s
FAREWELL = 0.05  # s
SOON = 0.01  # s, between the clocks of a ride and of its bench
ROOM = 0.1  # s, for what a virtual machine takes now and then


class Rides:
    """With a profile that has little patience with ramps, a bicycle that leans to the right."""

    def __init__(self, host: Host, folder: Path) -> None:
        self._host, self.folder = host, folder

    def profile(self, drive: str = "cia402-emulated", **figures: Any) -> Path:
        # Nobody holds the bar: while its torque ramps out it turns far.
        usual = {
            "ramp_in": 0.05, "ramp_out": RAMP_OUT, "soft_stop_deg": 55.0, "trip_angle_deg": 60.0,
        }  # fmt: skip
        thresholds = {**usual, **figures.pop("thresholds", {})}
        return written(drive, self.folder, thresholds=thresholds, **figures)

    def __call__(self, path: Path, *arguments: str, **more: Any) -> Ridden:
        # A torque that stays much the same for as long as any of these rides.
        given = ("--duration", "5", "--speed", "3", "--set", "start.roll_deg=6")
        return ridden(self._host, path, *given, *arguments, **more)

    def with_mishap(self, kind: str, *, drive: str = "cia402-emulated", **figures: Any) -> Ridden:
        value = figures.pop("value", 0.0)
        mishap = Mishap(kind=kind, time=AT, value=value)  # pyright: ignore[reportArgumentType]
        return self(self.profile(drive, **figures), mishaps=(mishap,))


def named(seen: Ridden, row: int, says: str, *, answers: bool = True) -> None:
    """One line, the same on the display and in the record, which is whole; the drive disabled."""
    assert seen.status == 2, seen.err
    assert seen.err.count("\n") == 1, seen.err
    found = re.search(rf"fault {row}: {says}; allowed [^;]+", seen.err)
    assert found, seen.err
    safe(seen, answers=answers)
    run = seen.run()
    assert run.ending is not None
    assert run.ending.reason == found[0]
    assert seen.words[-1] == found[0]
    assert row in run.channel("fault")


def safe(seen: Ridden, *, answers: bool = True) -> None:
    """A torque that ended, a drive that is disabled, and no tick that is not in the record.

    `answers`: whether the drive could tell its host that it is disabled; for which the host waits
    `FAREWELL`.
    """
    assert seen.torques[-1][1] == 0.0
    assert not seen.enabled
    if seen.behind < FAREWELL:
        assert ("did not say that it is disabled: cut its power" in seen.out) != answers
    run = seen.run()
    assert run.channel("sent_torque")[-1] == 0.0
    # How late each tick is, of those that are in the record or were left out, in periods; a tick
    # that is missing makes all that come after it later by one.
    late = 1000 * run.time - np.arange(run.ticks) - run.channel("skipped")
    assert min(late[-50:]) - min(late[:50]) == pytest.approx(0.0, abs=0.99)


def rode(seen: Ridden) -> None:
    """There was a torque until then; of a bench that is behind the time, that much sooner."""
    lag = min(seen.behind, 0.05)  # what is more an emulated bench leaves out
    assert abs(seen.torque(AT - SOON - lag)) > 0.1


def zero_at_once(seen: Ridden, after: float = 0.0) -> None:
    """R3, `after` so many seconds: of a torque that was there, and not ramped out."""
    rode(seen)
    assert seen.zero_after - AT + seen.behind >= -SOON
    assert seen.zero_after - AT <= after + ROOM + seen.behind < after + RAMP_OUT
    assert abs(seen.run().channel("sent_torque")[-2]) > 0.05


def zero_when_seen(seen: Ridden, row: int) -> None:
    """R3, whatever torque there was: the tick that saw it is the last, and sends none."""
    run = seen.run()
    first = float(run.time[run.channel("fault") == row][0])
    assert run.time[-1] == first > AT
    assert run.channel("sent_torque")[-1] == 0.0
    assert seen.zero_after - first <= ROOM + seen.behind < RAMP_OUT


def let_go_by_itself(seen: Ridden) -> None:
    """The drive: not sooner than its watchdog says, which was fed a quarter of that before."""
    rode(seen)
    assert seen.zero_after - AT + seen.behind > 0.7 * WATCHDOG
    assert seen.zero_after - AT < WATCHDOG + ROOM + seen.behind < RAMP_OUT


def ramped_out(seen: Ridden, row: int, torque: float = 0.1) -> float:
    """R2: the torque falls evenly, after so long it is gone; when it began [s]."""
    run = seen.run()
    began = run.time[run.channel("fault") == row][0]
    sent = [abs(one) for one in run.channel("sent_torque")[run.time >= began]]
    assert sent[0] > torque
    assert all(a >= b for a, b in pairwise(sent))
    assert RAMP_OUT <= run.time[-1] - began <= RAMP_OUT + ROOM
    assert sent[len(sent) // 2] == pytest.approx(0.5 * sent[0], rel=0.2)
    assert 0.8 * RAMP_OUT <= seen.zero_after - began <= RAMP_OUT + ROOM + seen.behind
    return float(began)
