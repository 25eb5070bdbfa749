"""Rows 1 to 9: what the sensors say, or no longer say. A tick is 1 ms."""

import math

import pytest

from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION
from bikesim.bench.frame import Frame
from bikesim.bench.guard import HELD

from .faulted import (
    AT,
    LIMITED,
    SENT,
    STEER,
    fault_of,
    near,
    ramped_out,
    ridden,
    tampered,
    without,
    zeroed_at_once,
)
from .lockstep import LockStep, leaning, profile


def test_row_1_a_frame_lost_is_counted_and_bridged(bench: LockStep):
    ending = tampered(bench, without(STEER), duration=0.0025)
    assert ending.reason == "end of run"
    assert bench.rows.channel("frames_lost")[-1] == 3


def test_row_1_held_after_3_ms(bench: LockStep):
    ending = tampered(bench, without(STEER), duration=0.0085)
    assert ending.reason == "end of run"
    held = [row for row in bench.rows if int(row[LIMITED]) & HELD]
    assert [row[0] - AT for row in held] == [near(2.5 + i) for i in range(len(held))]
    assert 5 <= len(held) <= 7
    assert len({row[SENT] for row in held}) == 1


def test_row_1_ramped_after_10_ms_and_zero_after_20(bench: LockStep):
    ending = tampered(bench, without(STEER))
    assert fault_of(bench, ending, 1) == near(3)
    assert bench.rows[-1][0] - AT == near(20)
    torque = [abs(one) for one in bench.rows.channel("sent_torque")]
    assert torque[-12] > torque[-6] > torque[-2] > 0.5 * torque[-12]  # a tenth is ramped out


def test_row_1_ramped_out_if_it_comes_back_between(bench: LockStep):
    ending = tampered(bench, without(STEER), duration=0.015)
    fault_of(bench, ending, 1)
    assert bench.rows[-1][0] - AT == near(10 + 100)


def test_row_2_three_wrong_checksums(bench: LockStep):
    def corrupt(frame: Frame) -> list[Frame]:
        if frame.id != STEER:
            return [frame]
        return [frame._replace(data=bytes((frame.data[0] ^ 1,)) + frame.data[1:])]

    assert fault_of(bench, tampered(bench, corrupt), 2) == near(2)
    assert zeroed_at_once(bench)


def test_row_2_two_of_them_are_dropped(bench: LockStep):
    def corrupt(frame: Frame) -> list[Frame]:
        return [frame._replace(data=bytes(8))] if frame.id == STEER else [frame]

    assert tampered(bench, corrupt, duration=0.0015).reason == "end of run"
    assert max(abs(steer) for steer in bench.rows.channel("steer")) > 0


def test_row_3_a_frame_repeated(bench: LockStep):
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
def test_row_4_potentiometer_open_or_short(bench: LockStep, raw: float):
    ending = ridden(bench, lambda since: setattr(bench.plant.node, "pot", raw))
    assert fault_of(bench, ending, 4) == near(1)
    assert "potentiometer" in ending.reason
    assert zeroed_at_once(bench)


def test_row_5_potentiometer_slipping(bench: LockStep):
    node = bench.plant.node

    def slip(since: float) -> None:
        node.pot = 0.5 + (node.steer + 1.0 * since) / 5.76

    # 20 ms, and what the filter of both takes to see 0.5 of 1.0 rad/s.
    after = fault_of(bench, ridden(bench, slip), 5)
    assert 0.020 < after < 0.050
    assert zeroed_at_once(bench)


def test_row_5_potentiometer_stuck(bench: LockStep):
    node = bench.plant.node
    stuck: list[float] = []

    def stick(since: float) -> None:
        stuck.append(0.5 + node.steer / 5.76)
        node.pot = stuck[0]
        node.gyro = 0.5 + 1.0 / 10.47  # it turns

    assert 0.020 < fault_of(bench, ridden(bench, stick), 5) < 0.050
    assert zeroed_at_once(bench)


def test_row_6_gyro_bias():
    bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning(duration=2.0))
    node = bench.plant.node

    def bias(since: float) -> None:
        node.gyro = 0.5 + (node.steer_rate + 0.1) / 10.47

    # 0.1 rad/s × 2 s × (1 - exp(-t/2 s)) reaches 0.05 rad after 0.575 s.
    after = fault_of(bench, ridden(bench, bias), 6)
    assert after == pytest.approx(0.575, abs=0.02)
    assert ramped_out(bench)


@pytest.mark.parametrize("jump", [0.025, -0.5])
def test_row_7_angle_step(bench: LockStep, jump: float):
    node = bench.plant.node

    def jumped(since: float) -> None:
        node.pot = 0.5 + (node.steer + jump) / 5.76

    assert fault_of(bench, ridden(bench, jumped), 7) == near(1)
    assert zeroed_at_once(bench)


def test_row_8_soft_stop_and_over_angle():
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


def test_row_9_over_speed(bench: LockStep):
    node = bench.plant.node
    # A gyro of ±600 deg/s: one of ±300 is out of range before.
    node.sensors = node.stored = USUAL_CALIBRATION._replace(rate_scale=20.94)

    def fast(since: float) -> None:
        node.pot = 0.5 + (node.steer + 9.0 * since) / 5.76
        node.gyro = 0.5 + 9.0 / 20.94

    assert 0.0015 < fault_of(bench, ridden(bench, fast), 9) < 0.0045
    assert zeroed_at_once(bench)
