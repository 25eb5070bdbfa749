import time

import pytest

from bikesim.clock import RealTimeClock, SimulatedClock


def test_time_begins_at_zero():
    assert SimulatedClock(1e-3).now == 0.0


def test_time_passes_only_when_it_is_told_to():
    clock = SimulatedClock(0.25)
    clock.advance()
    assert clock.now == clock.now == 0.25


def test_rounding_does_not_accumulate():
    clock = SimulatedClock(1e-3)
    for _ in range(100_000):
        clock.advance()
    assert clock.now == 100.0


class World:
    """A clock that only sleep and work move on; sleep oversleeps."""

    def __init__(self, oversleep: float = 0.0) -> None:
        self.time, self._oversleep = 1000.0, oversleep

    def clock(self) -> float:
        return self.time

    def sleep(self, duration: float) -> None:
        assert duration > 0
        self.time += duration + self._oversleep


def real(world: World) -> RealTimeClock:
    return RealTimeClock(0.01, clock=world.clock, sleep=world.sleep)


def test_it_wakes_at_whole_periods_whatever_a_tick_takes():
    world = World()
    clock = real(world)
    for k, work in enumerate((0.001, 0.009, 0.0, 0.005), start=1):
        world.time += work
        wake = clock.wait()
        assert wake == (pytest.approx(0.0, abs=1e-9), 0)
        assert clock.now == pytest.approx(0.01 * k)


def test_sleeping_too_long_is_told_and_does_not_add_up():
    world = World(oversleep=0.002)
    clock = real(world)
    lates = [clock.wait().late for _ in range(50)]
    assert lates == pytest.approx([0.002] * 50)
    assert clock.now == pytest.approx(0.502)


def test_a_tick_that_is_late_by_less_than_a_period_goes_on_at_once():
    world = World()
    clock = real(world)
    world.time += 0.013
    assert clock.wait() == (pytest.approx(0.003), 0)
    assert clock.wait() == (pytest.approx(0.0, abs=1e-9), 0)


def test_deadlines_that_are_past_are_skipped_and_not_run_through():
    world = World()
    clock = real(world)
    world.time += 0.0457
    assert clock.wait() == (pytest.approx(0.0057), 3)
    assert clock.wait() == (pytest.approx(0.0, abs=1e-9), 0)
    assert clock.now == pytest.approx(0.05)


def test_a_sleep_that_is_much_too_long_is_one_late_tick_and_no_burst():
    world = World(oversleep=0.0357)
    clock = real(world)
    assert clock.wait() == (pytest.approx(0.0057), 3)
    world._oversleep = 0.0
    assert clock.wait() == (pytest.approx(0.0, abs=1e-9), 0)
    assert clock.now == pytest.approx(0.05)


def test_start_sets_time_to_zero():
    world = World()
    clock = real(world)
    world.time += 5.0
    clock.start()
    assert clock.now == 0.0
    assert clock.left == pytest.approx(0.01)


def test_on_the_real_clock_time_is_measured():
    clock = RealTimeClock(0.002)
    before = time.perf_counter()
    for _ in range(5):
        assert clock.wait().late >= 0
    assert clock.now >= 0.01
    assert clock.now <= time.perf_counter() - before + 0.1
