"""Rides in lock-step in which something goes wrong, and how they must have ended."""

import math
from collections.abc import Callable, Set
from itertools import pairwise

import pytest

from bikesim.bench.frame import Frame
from bikesim.record.header import Ending

from .lockstep import NAMES, LockStep

AT = 0.9
"""Of the ride, when it goes wrong [s]."""

STEER = 0x110
LIMITED, SENT = NAMES.index("limited"), NAMES.index("sent_torque")


def ridden(bench: LockStep, wrong: Callable[[float], object] | None = None) -> Ending:
    """A ride to which `wrong` is done from AT on, at each tick, with the time since."""
    show = bench.plant.show

    def shown(bicycle) -> None:
        show(bicycle)
        since = bicycle.time - AT
        if wrong is not None and since > -1e-5:
            wrong(since)

    def hooked() -> None:
        bench.parts.rig.hooks = bench.parts.rig.hooks._replace(show=shown)

    return bench.ride(before=hooked)


def tampered(bench: LockStep, change: Callable[[Frame], list[Frame]], duration=math.inf) -> Ending:
    """A ride in which frames of the devices are changed from AT on."""

    def tamper(frame: Frame, time: float) -> list[Frame]:
        since = time - bench.began - AT
        return change(frame) if -1e-9 < since < duration else [frame]

    bench.sim.tamper = tamper
    return ridden(bench)


def without(identifier: int) -> Callable[[Frame], list[Frame]]:
    return lambda frame: [] if frame.id == identifier else [frame]


def fault_of(bench: LockStep, ending: Ending, row: int) -> float:
    """Sees that it ended by this fault, named with figures, safely; when after AT [s]."""
    assert ending.reason.startswith(f"fault {row}: "), ending.reason
    assert "; allowed " in ending.reason
    assert bench.guard is not None
    assert bench.guard.fault is not None
    assert bench.guard.fault.row == row
    safe(bench)
    faults = bench.rows.channel("fault")
    first = next(i for i, one in enumerate(faults) if one == row)
    return bench.rows[first][0] - AT


def safe(bench: LockStep) -> None:
    """Zero torque at the end, the drive disabled, and the port closed.

    Of a drive that cannot say that it is disabled, the rig must not say so.
    """
    assert bench.plant.torque == 0.0
    assert (bench.parts.rig.disabled is True) == bench.answers
    assert bench.sim.closed
    assert bench.rows.channel("sent_torque")[-1] == 0.0


def zeroed_at_once(bench: LockStep) -> bool:
    """The last tick is zero and the one before is not: nothing was ramped."""
    *_, before, last = bench.rows.channel("sent_torque")
    return last == 0.0 and abs(before) > 0.1


def ramped_out(bench: LockStep) -> bool:
    """Over the last 100 ms the torque falls, evenly, to zero."""
    *_, last = [abs(torque) for torque in bench.rows.channel("sent_torque")]
    out = [abs(torque) for torque in bench.rows.channel("sent_torque")[-100:-1]]
    drops = [a - b for a, b in pairwise(out)]
    return last == 0.0 and out[0] > 0.1 and max(drops) - min(drops) < 0.01 and min(drops) >= 0


def near(milliseconds: float):
    """In ticks of 1 ms."""
    return pytest.approx(milliseconds * 1e-3, abs=1.6e-3)


def silent(bench: LockStep, ids: Set[int]) -> Ending:
    """A ride in which the drive no longer sends these."""
    bench.answers = not ids & {0x185, 3 << 5 | 1}
    return tampered(bench, lambda frame: [] if frame.id in ids else [frame])


def hold(bench: LockStep) -> None:
    """Somebody holds the bar tight, so that a torque does not turn it."""
    advance = bench.plant.advance

    def held() -> None:
        bench.plant.bar.data.qvel[0] = 0.0
        bench.plant.bar.data.qpos[0] = 0.0
        advance()

    bench.plant.advance = held
