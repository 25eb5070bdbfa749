"""Watchers that are asked together find what each of them would."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bikesim.bench.faults import Fault, Observation, Reaction, Thresholds
from bikesim.bench.monitors import AtOnce, monitors

from .observed import SOUND

TIMES = st.one_of(st.floats(0, 0.2), st.sampled_from((0.003, 0.005, 0.01, 0.02, 0.15, math.inf)))
COUNTS = st.integers(0, 5)
WORDS = st.sampled_from(("", "", "wrong"))
MOSTLY = st.sampled_from((True, True, True, False))
OBSERVATIONS = st.builds(
    SOUND._replace,
    steer=st.one_of(st.floats(-2, 2), st.just(math.nan), st.just(math.radians(45.0))),
    age=TIMES,
    bad_frames=COUNTS,
    frozen_frames=COUNTS,
    pot_ok=MOSTLY,
    gyro_ok=MOSTLY,
    vref_ok=MOSTLY,
    estop_closed=MOSTLY,
    drive_age=TIMES,
    drive_heartbeat_age=TIMES,
    drive_trouble=WORDS,
    drive_error=WORDS,
    bus_trouble=WORDS,
    second_master=st.booleans(),
)


@given(OBSERVATIONS)
@example(SOUND)
@example(SOUND._replace(age=math.nan))
@example(SOUND._replace(drive_age=math.inf))
@example(SOUND._replace(bad_frames=3))
def test_asked_together_or_one_by_one(seen: Observation):
    together = AtOnce(Thresholds(), heartbeat_period=0.1)
    found = [fault for look in together.each if (fault := look(seen)) is not None]
    gravest = max((fault.reaction for fault in found), default=None)
    fault = together(seen)
    assert (fault and fault.reaction) == gravest
    assert fault is None or fault == next(one for one in found if one.reaction == gravest)


def test_each_bound_is_looked_at():
    """One by one out of bounds: nothing else says it."""
    together = AtOnce(Thresholds(), heartbeat_period=0.1)
    assert together(SOUND) is None
    rows = {
        21: {"estop_closed": False}, 20: {"bus_trouble": "x"}, 24: {"second_master": True},
        17: {"drive_error": "x"}, 15: {"drive_trouble": "x"}, 14: {"drive_age": 0.006},
        1: {"age": 0.004}, 2: {"bad_frames": 3}, 3: {"frozen_frames": 3}, 4: {"pot_ok": False},
        8: {"steer": -0.8},
    }  # fmt: skip
    for row, changed in rows.items():
        fault = together(SOUND._replace(**changed))
        assert fault is not None
        assert fault.row == row
    assert len(rows) == len(together.each)


def first(**changed: object) -> tuple[float, Fault]:
    """The first fault of all watchers, each ms, and when [s]; of what is changed at 1 s."""
    watch = monitors(Thresholds(), heartbeat_period=0.1)
    for tick in range(3000):
        time = 1e-3 * tick
        o = SOUND._replace(time=time, sample_time=time)
        o = o._replace(**changed) if tick >= 1000 else o
        for look in watch:
            if (fault := look(o)) is not None:
                return time, fault
    raise AssertionError


@pytest.mark.parametrize(
    ("changed", "row", "after"),
    [
        ({"torque_measured": math.nan}, 16, 0.020),
        ({"torque_sent": math.nan}, 16, 0.020),
        ({"steer": math.nan}, 8, 0.0),
    ],
    ids=str,
)
def test_what_is_no_number_is_out_of_bounds(changed: dict, row: int, after: float):
    time, fault = first(**changed)
    assert (fault.row, fault.reaction) == (row, Reaction.ZERO)
    assert time - 1.0 == pytest.approx(after, abs=1e-3)


def test_a_rate_that_is_no_number_is_out_of_bounds():
    time, fault = first(steer_rate=math.nan)
    assert fault.row in (6, 9)
    assert time - 1.0 < 0.003


def skipping(every: int, duration: float) -> Fault | None:
    """Each so many-th tick is left out; the fault, if there is one."""
    watch = monitors(Thresholds(), heartbeat_period=0.1)
    for tick in range(round(1000 * duration)):
        if tick % every == every - 1:
            continue
        late = tick % every == 0 and tick > 0
        o = SOUND._replace(
            time=1e-3 * tick, sample_time=1e-3 * tick, late=1.2e-3 * late, skipped=int(late)
        )
        for look in watch:
            if (fault := look(o)) is not None:
                return fault
    return None


def test_row_19_a_tenth_of_the_ticks_left_out_is_allowed_and_more_is_not():
    assert skipping(11, 20.0) is None
    fault = skipping(9, 20.0)
    assert fault is not None
    assert (fault.row, fault.reaction) == (19, Reaction.RAMP)
    assert str(fault) == "fault 19: 10 % of the ticks of a second left out; allowed 10 %"
