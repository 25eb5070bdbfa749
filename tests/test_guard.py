import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bikesim.guard import CLAMPED, REFUSED, SLEWED, Guard, GuardSettings

PERIOD, STOP = 1e-3, math.radians(60)
FAST = 1e6  # [N m/s], so that nothing is slewed


def guard(limit: float = 10.0, rate: float = FAST, fall_deg: float = 45.0) -> Guard:
    figures = GuardSettings(torque_limit=limit, torque_rate_limit=rate, fall_roll_deg=fall_deg)
    return Guard(figures, PERIOD, STOP)


def test_a_torque_within_limits_passes():
    assert guard().check(0.1, 0.1, 3.3) == (3.3, 0, None)


@pytest.mark.parametrize(("torque", "allowed"), [(10.5, 10.0), (-99.0, -10.0), (1e300, 10.0)])
def test_a_large_torque_is_clamped(torque: float, allowed: float):
    assert guard().check(0, 0, torque) == (allowed, CLAMPED, None)


def test_the_limit_itself_is_allowed():
    assert guard().check(0, 0, -10.0) == (-10.0, 0, None)


def test_a_torque_starts_from_zero():
    verdict = guard(rate=300.0).check(0, 0, 5.0)
    assert verdict == (pytest.approx(0.3), SLEWED, None)


def test_a_torque_changes_by_its_rate_at_most():
    slow = guard(rate=1000.0)
    torques = [slow.check(0, 0, wanted).torque for wanted in (2.5, 2.5, 2.5, -2.5, 0.6)]
    assert torques == pytest.approx([1.0, 2.0, 2.5, 1.5, 0.6])


def test_it_is_clamped_first_and_then_slewed():
    """So that it leaves the limit at once when the wish does."""
    slow = guard(limit=2.0, rate=1000.0)
    verdicts = [slow.check(0, 0, wanted) for wanted in (50.0, 50.0, 50.0, 1.5)]
    assert [verdict.torque for verdict in verdicts] == pytest.approx([1.0, 2.0, 2.0, 1.5])
    assert [verdict.limited for verdict in verdicts] == [CLAMPED | SLEWED, CLAMPED, CLAMPED, 0]


def test_the_rate_is_per_second_not_per_tick():
    figures = GuardSettings(torque_rate_limit=100.0)
    assert Guard(figures, 0.02, STOP).check(0, 0, 9.0).torque == pytest.approx(2.0)


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_a_torque_that_is_not_finite_is_a_fault(torque: float):
    verdict = guard().check(0.0, 0.0, torque)
    assert (verdict.torque, verdict.limited) == (0.0, REFUSED)
    assert verdict.stop is not None
    assert (verdict.stop.fault, verdict.stop.fell) == (True, False)
    assert str(torque) in verdict.stop.reason


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["steer", "roll"])
def test_a_bicycle_that_is_not_finite_is_a_fault_and_no_fall(name: str, value: float):
    verdict = guard().check(**{"steer": 0.0, "roll": 0.0, "torque": 1.0, name: value})
    assert verdict.torque == 0.0
    assert verdict.stop is not None
    assert (verdict.stop.fault, verdict.stop.fell) == (True, False)
    assert name in verdict.stop.reason


@pytest.mark.parametrize(("degrees", "side"), [(45.1, "right"), (-45.1, "left")])
def test_beyond_45_degrees_of_roll_the_bicycle_has_fallen(degrees: float, side: str):
    verdict = guard().check(0.0, math.radians(degrees), 1.0)
    assert verdict.torque == 0.0
    assert verdict.stop is not None
    assert (verdict.stop.fell, verdict.stop.fault) == (True, False)
    assert side in verdict.stop.reason


@pytest.mark.parametrize("degrees", [44.9, -44.9])
def test_below_it_has_not(degrees: float):
    assert guard().check(0.0, math.radians(degrees), 1.0).stop is None


def test_the_angle_of_a_fall_is_set():
    assert guard(fall_deg=20).check(0, math.radians(21), 0).stop is not None


@pytest.mark.parametrize("sign", [1, -1])
def test_a_bar_at_its_stop_ends_the_run(sign: int):
    verdict = guard().check(sign * math.radians(59.9), 0.0, 1.0)
    assert verdict.torque == 0.0
    assert verdict.stop is not None
    assert verdict.stop.fell
    assert "stop" in verdict.stop.reason


@pytest.mark.parametrize("sign", [1, -1])
def test_a_bar_short_of_its_stop_does_not(sign: int):
    assert guard().check(sign * math.radians(59), 0.0, 1.0).stop is None


def test_after_a_stop_a_torque_starts_from_zero_again():
    slow = guard(rate=1000.0)
    for _ in range(5):
        slow.check(0, 0, 5.0)
    slow.check(0, 1.0, 5.0)
    assert slow.check(0, 0, 5.0).torque == pytest.approx(1.0)


any_float = st.floats(allow_nan=True, allow_infinity=True)
ticks = st.lists(
    st.tuples(
        st.one_of(st.floats(-1, 1), any_float),
        st.one_of(st.floats(-0.7, 0.7), any_float),
        st.one_of(st.floats(-20, 20), any_float),
    ),
    max_size=12,
)


@settings(max_examples=100, deadline=None)
@given(
    ticks=ticks,
    limit=st.floats(1e-3, 100),
    rate=st.floats(1e-3, 1e6),
    period=st.floats(1e-4, 0.1),
)
def test_whatever_comes_the_torque_is_finite_within_its_limit_and_grows_at_its_rate(
    ticks: list[tuple[float, float, float]], limit: float, rate: float, period: float
):
    """A torque may only fall to zero faster than the rate: in a tick that stops."""
    one = Guard(GuardSettings(torque_limit=limit, torque_rate_limit=rate), period, STOP)
    before = 0.0
    for steer, roll, torque in ticks:
        verdict = one.check(steer, roll, torque)
        assert math.isfinite(verdict.torque)
        assert abs(verdict.torque) <= limit
        change = abs(verdict.torque - before)
        rounding = 1e-15 * limit
        assert change <= rate * period + rounding or (verdict.stop and verdict.torque == 0)
        before = verdict.torque
