from bikesim.clock import SimulatedClock


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
