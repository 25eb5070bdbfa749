"""Each row of the table of faults, on the wire or in the process: its reaction, and when.

In lock-step, so that times are those of the frames: a tick is 1 ms. Row 18 on the drive's side is
here too; with real processes it is in test_processes. Row 22 is in test_pulse, 24 and 25 before a
ride in test_arm.
"""

import math
from collections.abc import Callable, Set
from itertools import pairwise

import pytest

from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION
from bikesim.bench.frame import Frame
from bikesim.bench.guard import HELD
from bikesim.bench.odrive import AxisError
from bikesim.record.header import Ending

from .lockstep import DRIVES, LockStep, leaning, profile

AT = 0.9  # s of the ride, when it goes wrong
STEER = 0x110


@pytest.fixture(params=DRIVES)
def bench(request: pytest.FixtureRequest) -> LockStep:
    return LockStep(profile(DRIVES[request.param], thresholds={"ramp_in": 0.05}), leaning())


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


def test_without_a_fault_it_ends_as_planned_and_ramps_out(bench: LockStep):
    ending = ridden(bench)
    assert ending.reason == "end of run"
    assert bench.guard is not None
    assert bench.guard.seen == []
    assert ramped_out(bench)
    assert bench.rows[-1][0] == near(1400)
    safe(bench)


class TestSensor:
    def test_row_1_a_frame_lost_is_counted_and_bridged(self, bench: LockStep):
        ending = tampered(bench, without(STEER), duration=0.0025)
        assert ending.reason == "end of run"
        assert bench.rows.channel("frames_lost")[-1] == 3

    def test_row_1_held_after_3_ms(self, bench: LockStep):
        ending = tampered(bench, without(STEER), duration=0.0085)
        assert ending.reason == "end of run"
        held = [row for row in bench.rows if int(row[NAMES_LIMITED]) & HELD]
        assert [row[0] - AT for row in held] == [near(2.5 + i) for i in range(len(held))]
        assert 5 <= len(held) <= 7
        assert len({row[NAMES_SENT] for row in held}) == 1

    def test_row_1_ramped_after_10_ms_and_zero_after_20(self, bench: LockStep):
        ending = tampered(bench, without(STEER))
        assert fault_of(bench, ending, 1) == near(3)
        assert bench.rows[-1][0] - AT == near(20)
        torque = [abs(one) for one in bench.rows.channel("sent_torque")]
        assert torque[-12] > torque[-6] > torque[-2] > 0.5 * torque[-12]  # a tenth is ramped out

    def test_row_1_ramped_out_if_it_comes_back_between(self, bench: LockStep):
        ending = tampered(bench, without(STEER), duration=0.015)
        fault_of(bench, ending, 1)
        assert bench.rows[-1][0] - AT == near(10 + 100)

    def test_row_2_three_wrong_checksums(self, bench: LockStep):
        def corrupt(frame: Frame) -> list[Frame]:
            if frame.id != STEER:
                return [frame]
            return [frame._replace(data=bytes((frame.data[0] ^ 1,)) + frame.data[1:])]

        assert fault_of(bench, tampered(bench, corrupt), 2) == near(2)
        assert zeroed_at_once(bench)

    def test_row_2_two_of_them_are_dropped(self, bench: LockStep):
        def corrupt(frame: Frame) -> list[Frame]:
            return [frame._replace(data=bytes(8))] if frame.id == STEER else [frame]

        assert tampered(bench, corrupt, duration=0.0015).reason == "end of run"
        assert max(abs(steer) for steer in bench.rows.channel("steer")) > 0

    def test_row_3_a_frame_repeated(self, bench: LockStep):
        kept: list[Frame] = []

        def repeat(frame: Frame) -> list[Frame]:
            if frame.id != STEER:
                return [frame]
            kept.append(frame)
            return [kept[0]]

        # The first one that is kept is a good one.
        assert fault_of(bench, tampered(bench, repeat), 3) == near(3)
        assert zeroed_at_once(bench)

    @pytest.mark.parametrize("raw", [0.0, 1.0, 0.015, 0.985])
    def test_row_4_potentiometer_open_or_short(self, bench: LockStep, raw: float):
        ending = ridden(bench, lambda since: setattr(bench.plant.node, "pot", raw))
        assert fault_of(bench, ending, 4) == near(1)
        assert "potentiometer" in ending.reason
        assert zeroed_at_once(bench)

    def test_row_5_potentiometer_slipping(self, bench: LockStep):
        node = bench.plant.node

        def slip(since: float) -> None:
            node.pot = 0.5 + (node.steer + 1.0 * since) / 5.76

        # 20 ms, and what the filter of both takes to see 0.5 of 1.0 rad/s.
        after = fault_of(bench, ridden(bench, slip), 5)
        assert 0.020 < after < 0.050
        assert zeroed_at_once(bench)

    def test_row_5_potentiometer_stuck(self, bench: LockStep):
        node = bench.plant.node
        stuck: list[float] = []

        def stick(since: float) -> None:
            stuck.append(0.5 + node.steer / 5.76)
            node.pot = stuck[0]
            node.gyro = 0.5 + 1.0 / 10.47  # it turns

        assert 0.020 < fault_of(bench, ridden(bench, stick), 5) < 0.050
        assert zeroed_at_once(bench)

    def test_row_6_gyro_bias(self):
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning(duration=2.0))
        node = bench.plant.node

        def bias(since: float) -> None:
            node.gyro = 0.5 + (node.steer_rate + 0.1) / 10.47

        # 0.1 rad/s × 2 s × (1 - exp(-t/2 s)) reaches 0.05 rad after 0.575 s.
        after = fault_of(bench, ridden(bench, bias), 6)
        assert after == pytest.approx(0.575, abs=0.02)
        assert ramped_out(bench)

    @pytest.mark.parametrize("jump", [0.025, -0.5])
    def test_row_7_angle_step(self, bench: LockStep, jump: float):
        node = bench.plant.node

        def jumped(since: float) -> None:
            node.pot = 0.5 + (node.steer + jump) / 5.76

        assert fault_of(bench, ridden(bench, jumped), 7) == near(1)
        assert zeroed_at_once(bench)

    def test_row_8_soft_stop_and_over_angle(self):
        """Pushed to the stop by hand: 2 rad/s from AT on."""
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
        data = bench.plant.bar.data

        def push(since: float) -> None:
            data.qvel[0] = 2.0

        at = fault_of(bench, ridden(bench, push), 8)
        steer = bench.rows.channel("steer")
        assert math.degrees(steer[-1]) == pytest.approx(45.1, abs=0.15)
        assert at > 0
        soft = [row for row in bench.rows if math.radians(40) < row[1] < math.radians(44)]
        # Halfway between soft stop and trip, outwards at most half of what the law wants.
        outwards = [row for row in soft if row[13] > 0]
        assert all(0 <= row[15] <= 0.52 * row[13] for row in outwards)

    def test_row_9_over_speed(self, bench: LockStep):
        node = bench.plant.node
        # A gyro of ±600 deg/s: one of ±300 is out of range before.
        node.sensors = node.stored = USUAL_CALIBRATION._replace(rate_scale=20.94)

        def fast(since: float) -> None:
            node.pot = 0.5 + (node.steer + 9.0 * since) / 5.76
            node.gyro = 0.5 + 9.0 / 20.94

        assert 0.0015 < fault_of(bench, ridden(bench, fast), 9) < 0.0045
        assert zeroed_at_once(bench)


class TestTorque:
    @pytest.mark.parametrize("wanted", [math.nan, math.inf, -math.inf])
    def test_row_10_nan(self, bench: LockStep, wanted: float):
        ride = bench.prepared()
        bench.arm()
        ride._haptics = lambda time, torque: wanted if time >= AT else torque
        assert fault_of(bench, ride.go(), 10) == near(0)
        assert zeroed_at_once(bench)

    def test_row_11_clamped_and_saturated(self):
        bench = LockStep(
            profile(thresholds={"ramp_in": 0.05}), leaning(start={"roll_deg": 0.1}, duration=2.0)
        )
        ride = bench.prepared()
        bench.arm()
        ride._haptics = lambda time, torque: 5.0 if time >= AT else torque
        hold(bench)
        assert fault_of(bench, ride.go(), 11) == near(501)
        assert max(bench.rows.channel("sent_torque")) <= 3.5
        assert ramped_out(bench)

    def test_row_12_slewed(self, bench: LockStep):
        ride = bench.prepared()
        bench.arm()
        hold(bench)
        turns = iter(range(10**6))
        ride._haptics = lambda time, torque: -3.4 if next(turns) % 2 else 3.4
        assert fault_of(bench, ride.go(), 12) < 0
        torque = bench.rows.channel("sent_torque")
        steps = [abs(a - b) for a, b in pairwise(torque)]
        assert max(steps[:-1]) <= 0.3 + 0.003

    def test_row_13_warm(self):
        bench = LockStep(
            profile(
                thresholds={"ramp_in": 0.05, "thermal_time": 0.5, "cooled_time": 0.3},
                limits={"torque": 3.5, "continuous_torque": 1.0},
            ),
            leaning(),
        )
        ride = bench.prepared()
        bench.arm()
        hold(bench)
        ride._haptics = lambda time, torque: 2.0
        fault_of(bench, ride.go(), 13)
        # 4 (1 - exp(-t/0.5 s)) reaches 1 at 0.144 s; from there on less and less comes out.
        scaled = next(i for i, one in enumerate(bench.rows.channel("limited")) if int(one) & 32)
        assert bench.rows[scaled][0] == pytest.approx(0.144 + 0.05, abs=0.06)
        torque = bench.rows.channel("sent_torque")
        assert torque[scaled] > torque[scaled + 200] > 0.95
        assert ramped_out(bench)


class TestDrive:
    def test_row_14_silent(self, bench: LockStep):
        ids = bench.drive.ids
        after = fault_of(bench, silent(bench, ids), 14)
        # After 5 ms; the encoder frames of an ODrive come each ms, the status with each SYNC.
        assert after == near(6)
        assert zeroed_at_once(bench)

    def test_row_14_heartbeat_gone(self, bench: LockStep):
        beat = 0x705 if bench.bench.drive.kind == "cia402" else 3 << 5 | 1
        after = fault_of(bench, silent(bench, {beat}), 14)
        assert 0.005 <= after <= 0.0165
        assert zeroed_at_once(bench)

    def test_row_15_wrong_state(self, bench: LockStep):
        device = bench.plant.drive

        def disable(since: float) -> None:
            if isinstance(device, EmulatedDrive):
                device._power.disable()
            else:
                assert isinstance(device, EmulatedODrive)
                device._request(1)

        after = fault_of(bench, ridden(bench, disable), 15)
        assert after <= (0.0025 if bench.bench.drive.kind == "cia402" else 0.0115)

    def test_row_15_wrong_mode(self):
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
        device = bench.plant.drive
        assert isinstance(device, EmulatedDrive)
        ending = ridden(bench, lambda since: device.objects.set(0x6061, 0, 8))
        # The frame that says so, or the torque that is missing: whichever is first.
        assert fault_of(bench, ending, 15) <= 0.0025
        assert "mode 8" in ending.reason

    def test_row_16_torque_not_followed(self):
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning(start={"roll_deg": 13.0}))
        device = bench.plant.drive
        assert isinstance(device, EmulatedDrive)
        ending = ridden(bench, lambda since: device.objects.set(0x6072, 0, 0))
        assert fault_of(bench, ending, 16) == near(21)
        assert zeroed_at_once(bench)

    def test_row_17_error(self, bench: LockStep):
        device = bench.plant.drive

        def fail(since: float) -> None:
            if isinstance(device, EmulatedDrive):
                device.fail(0x2310, bench.sim._devices_began + bench.sim.now)
            else:
                assert isinstance(device, EmulatedODrive)
                device.fail(AxisError.DC_BUS_OVER_CURRENT)

        ending = ridden(bench, fail)
        after = fault_of(bench, ending, 17)
        assert after <= (0.0025 if bench.bench.drive.kind == "cia402" else 0.0115)
        assert ("0x2310" if bench.bench.drive.kind == "cia402" else "over current") in ending.reason

    def test_row_18_the_host_is_gone(self, bench: LockStep):
        """Hung, killed, cut off: the drive disables itself, whatever torque it had."""
        ride = bench.prepared()
        bench.arm()

        class Gone(Exception):
            pass

        def gone(time: float, torque: float) -> float:
            if time > AT:
                raise Gone
            return torque

        ride._haptics = gone
        began = bench.sim.now
        bench.sim.tamper_host = lambda frame, time: [frame] if time < began + AT else []
        torque: list[float] = []
        advance = bench.plant.advance

        def advanced() -> None:
            torque.append(bench.plant.torque)
            advance()

        bench.plant.advance = advanced
        with pytest.raises(Gone):
            ride.go()
        while bench.sim.now < began + AT + 0.1:
            bench.sim._advance()
        alone = torque[round(AT / 0.001) :]
        assert abs(alone[0]) > 0.1
        # 30 ms from the last heartbeat or torque command; a heartbeat comes each 7.5 ms.
        assert 21 <= sum(one != 0.0 for one in alone) <= 31
        assert alone[-1] == 0.0


class TestHost:
    def test_row_19_a_late_tick_is_no_fault_but_counted(self, bench: LockStep):
        def late(since: float) -> None:
            if since < 0.0005:
                bench.sim.hang = 0.0019

        ending = ridden(bench, late)
        assert ending.reason == "end of run"
        assert bench.rows.channel("skipped")[-1] == 2
        steps = [b[0] - a[0] for a, b in pairwise(bench.rows)]
        assert max(steps) == pytest.approx(0.003, abs=2e-6)
        assert sum(step > 0.0015 for step in steps) == 1

    def test_row_19_one_very_late(self):
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

    def test_row_19_twenty_late_in_a_row(self, bench: LockStep):
        def late(since: float) -> None:
            if since < 0.085:
                bench.sim.hang = 0.002

        after = fault_of(bench, ridden(bench, late), 19)
        # Each tick is three periods after the last one.
        assert after == near(20 * 3)
        assert bench.rows[-1][0] - AT == near(160)

    def test_row_20_the_bus_fails(self, bench: LockStep):
        ending = ridden(bench, lambda since: setattr(bench.sim, "trouble", "bus-off"))
        assert ending.reason == "fault 20: bus-off; allowed a sound bus"
        assert bench.plant.torque == 0.0

    def test_row_21_emergency_stop(self, bench: LockStep):
        ending = ridden(bench, lambda since: setattr(bench.plant.node, "estop_closed", False))
        assert fault_of(bench, ending, 21) == near(1)
        assert zeroed_at_once(bench)

    def test_row_23_the_rider_fell(self):
        bench = LockStep(
            profile(thresholds={"ramp_in": 0.05, "fall_roll_deg": 15.0}),
            leaning(speed=2.0, duration=10.0),
        )
        ending = ridden(bench)
        assert ending.fell
        assert ending.reason == "fell to the right: roll beyond 15 deg"
        assert ramped_out(bench)
        safe(bench)

    def test_row_24_a_second_master(self, bench: LockStep):
        command = 0x205 if bench.bench.drive.kind == "cia402" else 3 << 5 | 0x0E

        def other(frame: Frame) -> list[Frame]:
            return [frame, Frame(command, bytes(8))] if frame.id == STEER else [frame]

        assert fault_of(bench, tampered(bench, other), 24) == near(0)
        assert zeroed_at_once(bench)

    def test_row_25_the_torque_ramps_in_over_a_second(self):
        bench = LockStep(profile(), leaning())
        ridden(bench)
        sent, wanted = (bench.rows.channel(n) for n in ("sent_torque", "feedback_torque"))
        assert sent[0] == 0.0
        for tick in (250, 500, 750):
            assert sent[tick] == pytest.approx(tick / 1000 * wanted[tick], abs=0.003)
        assert sent[1100] == pytest.approx(wanted[1100], abs=0.003)


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


NAMES_LIMITED, NAMES_SENT = 16, 15
