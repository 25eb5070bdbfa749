"""Rows 10 to 13 and 25: the torque itself. A tick is 1 ms."""

import math
from itertools import pairwise

import pytest

from .faulted import (
    AT,
    fault_of,
    hold,
    near,
    ramped_out,
    ridden,
    zeroed_at_once,
)
from .lockstep import LockStep, leaning, profile


@pytest.mark.parametrize("wanted", [math.nan, math.inf, -math.inf])
def test_row_10_nan(bench: LockStep, wanted: float):
    ride = bench.prepared()
    bench.arm()
    ride._haptics = lambda time, torque: wanted if time >= AT else torque
    assert fault_of(bench, ride.go(), 10) == near(0)
    assert zeroed_at_once(bench)


def test_row_11_clamped_and_saturated():
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


def test_row_12_slewed(bench: LockStep):
    ride = bench.prepared()
    bench.arm()
    hold(bench)
    turns = iter(range(10**6))
    ride._haptics = lambda time, torque: -3.4 if next(turns) % 2 else 3.4
    # 3.4 k/50 N m in tick k, one way and the other, while it ramps in: from the third on a step is
    # more than 0.3 N m. 21 in a row are too many, which the tick after them sees.
    assert fault_of(bench, ride.go(), 12) + AT == near(3 + 21)
    assert ramped_out(bench)
    torque = bench.rows.channel("sent_torque")
    steps = [abs(a - b) for a, b in pairwise(torque)]
    assert max(steps[:-1]) <= 0.3 + 0.003


def test_row_13_warm():
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


def test_row_25_the_torque_ramps_in_over_a_second():
    bench = LockStep(profile(), leaning())
    ridden(bench)
    sent, wanted = (bench.rows.channel(n) for n in ("sent_torque", "feedback_torque"))
    assert sent[0] == 0.0
    for tick in (250, 500, 750):
        assert sent[tick] == pytest.approx(tick / 1000 * wanted[tick], abs=0.003)
    assert sent[1100] == pytest.approx(wanted[1100], abs=0.003)
