"""The guard of a batch decides for each rig as the guard of one."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bikesim.experiment.batch_guard import BatchGuard
from bikesim.guard import Guard, GuardSettings
from bikesim.rig.batch import Riding

PERIOD, STOP = 1e-3, math.radians(60)
LIMITS = GuardSettings(torque_limit=2.0, torque_rate_limit=900.0)

steers = st.floats(-1.2, 1.2) | st.sampled_from([math.nan, math.inf])
rolls = st.floats(-0.9, 0.9) | st.sampled_from([math.nan, -math.inf, 0.8, -0.8])
torques = st.floats(-5, 5) | st.sampled_from([math.nan, math.inf, 2.0, -2.0, 1e300])
ticks = st.tuples(
    *(st.floats(-0.5, 0.5) for _ in range(2)), st.floats(-5, 5)
) | st.tuples(steers, rolls, torques)  # fmt: skip


@given(st.lists(st.lists(ticks, min_size=4, max_size=4), min_size=1, max_size=20))
@settings(max_examples=100, deadline=None)
def test_as_the_guard_of_one(table: list[list[tuple[float, float, float]]]):
    rigs = 4
    riding = Riding(rigs)
    many = BatchGuard(LIMITS, PERIOD, STOP, riding)
    ones = [Guard(LIMITS, PERIOD, STOP) for _ in range(rigs)]
    stopped: dict[int, tuple] = {}
    for tick, row in enumerate(table):
        with np.errstate(all="ignore"):
            verdict = many.check(*(np.array(column) for column in zip(*row, strict=True)))
        for rig, one in enumerate(ones):
            if rig in stopped:
                assert verdict.torque[rig] == 0.0
                continue
            alone = one.check(*row[rig])
            assert verdict.torque[rig] == alone.torque
            assert verdict.limited[rig] == alone.limited
            if alone.stop is not None:
                stopped[rig] = (alone.stop, tick)
        assert riding.mask.tolist() == [rig not in stopped for rig in range(rigs)]
        assert (verdict.stop is not None) == (len(stopped) == rigs)
        if verdict.stop is not None:
            break
    for rig in range(rigs):
        assert many.stops[rig] == stopped.get(rig) or "nan" in str(many.stops[rig])


@pytest.mark.parametrize("rig", [0, 1])
def test_it_tells_why_each_stopped(rig: int):
    guard = BatchGuard(LIMITS, PERIOD, STOP, Riding(2))
    guard.check(np.zeros(2), np.array([0.0, 0.0]), np.zeros(2))
    roll = np.zeros(2)
    roll[rig] = -0.9
    verdict = guard.check(np.zeros(2), roll, np.ones(2))
    assert verdict.stop is None
    assert guard.stops[1 - rig] is None
    stopped = guard.stops[rig]
    assert stopped is not None
    assert stopped[1] == 1
    assert "fell to the left" in stopped[0].reason
