"""Rows 19 to 24: loop, bus, emergency stop, rider and other hosts. A tick is 1 ms.

Row 22 is in test_pulse, 24 and 25 before a ride in test_arm.
"""

from itertools import count, pairwise

import pytest

from bikesim.bench.frame import Frame

from .faulted import (
    AT,
    STEER,
    fault_of,
    near,
    ramped_out,
    ridden,
    safe,
    tampered,
    zeroed_at_once,
)
from .lockstep import DRIVES, LockStep, leaning, profile


def test_without_a_fault_it_ends_as_planned_and_ramps_out(bench: LockStep):
    ending = ridden(bench)
    assert ending.reason == "end of run"
    assert bench.guard is not None
    assert bench.guard.seen == []
    assert ramped_out(bench)
    assert bench.rows[-1][0] == near(1400)
    safe(bench)


def test_row_19_a_late_tick_is_no_fault_but_counted(bench: LockStep):
    def late(since: float) -> None:
        if since < 0.0005:
            bench.sim.hang = 0.0019

    ending = ridden(bench, late)
    assert ending.reason == "end of run"
    assert bench.rows.channel("skipped")[-1] == 2
    steps = [b[0] - a[0] for a, b in pairwise(bench.rows)]
    assert max(steps) == pytest.approx(0.003, abs=2e-6)
    assert sum(step > 0.0015 for step in steps) == 1


def test_row_19_one_very_late():
    # Before the samples are so old that they are the graver fault.
    bench = LockStep(
        profile(
            thresholds={"ramp_in": 0.05, "late_most": 0.004},
        ),
        leaning(),
    )

    def late(since: float) -> None:
        if since < 0.0005:
            bench.sim.hang = 0.005

    assert fault_of(bench, ridden(bench, late), 19) == near(6)
    assert ramped_out(bench)


@pytest.mark.parametrize("kind", DRIVES)
def test_row_19_ten_late_in_a_row(kind: str):
    """Not for longer than the drive's watchdog waits, which they do not feed."""
    thresholds = {"ramp_in": 0.05, "late": 5e-4, "late_ticks": 10}
    bench = LockStep(profile(DRIVES[kind], thresholds=thresholds), leaning())

    def late(since: float) -> None:
        if since < 0.0195:
            bench.sim.hang = 0.001

    # Each tick is two periods after the last one.
    assert fault_of(bench, ridden(bench, late), 19) == near(10 * 2)
    assert bench.rows[-1][0] - AT == near(120)
    assert ramped_out(bench)


def test_row_19_every_fourth_tick_left_out_for_ever(bench: LockStep):
    """As where a tick takes 1.33 ms: never two late in a row, and 750 Hz instead of 1 kHz."""
    ticks = count()

    def late(since: float) -> None:
        if next(ticks) % 3 == 2:
            bench.sim.hang = 0.001

    # A quarter of the time: a tenth of a second is reached after 0.4 s, and passed by the next one.
    ending = ridden(bench, late)
    assert fault_of(bench, ending, 19) == near(404)
    assert ending.reason.startswith("fault 19: 10 % of the ticks of a second left out")
    assert ramped_out(bench)


def test_late_ticks_do_not_feed_the_watchdog(bench: LockStep):
    """Where each of them is late the drive disables itself, before row 19 has counted to 20."""

    def late(since: float) -> None:
        bench.sim.hang = 0.002

    after = fault_of(bench, ridden(bench, late), 17)
    # 30 ms from the last heartbeat or torque command; a heartbeat comes each 7.5 ms.
    told = 0.004 if bench.bench.drive.kind == "cia402" else 0.014  # by a status, or a heartbeat
    assert 0.021 <= after <= 0.030 + told


def test_one_late_tick_in_two_feeds_it(bench: LockStep):
    def late(since: float) -> None:
        if since < 0.1 and round(since * 1000) % 4 == 0:
            bench.sim.hang = 0.002

    assert ridden(bench, late).reason == "end of run"
    assert bench.rows.channel("skipped")[-1] > 40


def test_row_20_the_bus_fails(bench: LockStep):
    ending = ridden(bench, lambda since: setattr(bench.sim, "trouble", "bus-off"))
    assert ending.reason == "fault 20: bus-off; allowed a sound bus"
    assert bench.plant.torque == 0.0


def test_row_21_emergency_stop(bench: LockStep):
    ending = ridden(bench, lambda since: setattr(bench.plant.node, "estop_closed", False))
    assert fault_of(bench, ending, 21) == near(1)
    assert zeroed_at_once(bench)


def test_row_23_the_rider_fell():
    bench = LockStep(
        profile(thresholds={"ramp_in": 0.05, "fall_roll_deg": 15.0}),
        leaning(speed=2.0, duration=10.0),
    )
    ending = ridden(bench)
    assert ending.fell
    assert ending.reason == "fell to the right: roll beyond 15 deg"
    assert ramped_out(bench)
    safe(bench)


def test_row_23_a_bar_that_turns_far_while_one_falls_is_of_the_fall():
    """Whoever falls lets go: at once zero, and it is a fall all the same."""
    bench = LockStep(
        profile(thresholds={"ramp_in": 0.05, "ramp_out": 0.4, "fall_roll_deg": 15.0}),
        leaning(speed=2.0, duration=10.0),
    )

    def thrown(since: float) -> None:
        assert bench.guard is not None
        if bench.guard.fault is not None:
            bench.plant.bar.data.qvel[0] = 9.0

    ending = ridden(bench, thrown)
    assert ending.fell
    assert ending.reason == "fell to the right: roll beyond 15 deg"
    assert bench.guard is not None
    assert {fault.row for fault in bench.guard.seen} & {7, 8, 9}
    assert zeroed_at_once(bench)
    safe(bench)


def test_row_24_a_second_master(bench: LockStep):
    command = 0x205 if bench.bench.drive.kind == "cia402" else 3 << 5 | 0x0E

    def other(frame: Frame) -> list[Frame]:
        return [frame, Frame(command, bytes(8))] if frame.id == STEER else [frame]

    assert fault_of(bench, tampered(bench, other), 24) == near(0)
    assert zeroed_at_once(bench)
