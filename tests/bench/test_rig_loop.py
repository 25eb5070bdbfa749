"""The bench's loop on a clock that oversleeps, and its farewell on a bus that is in trouble."""

from collections.abc import Iterable
from itertools import pairwise

import pytest

from bikesim.bench.drives import make_drive
from bikesim.bench.frame import Frame
from bikesim.bench.parts import Parts
from bikesim.clock import RealTimeClock

from .lockstep import DRIVES, profile

PERIOD = 0.001


class World:
    """Time, which passes by waiting alone; and a bus on which nobody answers."""

    wakes_late = 0.0
    trouble = ""

    def __init__(self, *, sends: bool = True, hears: bool = True) -> None:
        self.time = 100.0
        self.oversleep = 0.0
        self._sends, self._hears = sends, hears
        self.sent: list[tuple[float, Frame]] = []
        self.closed = False

    def clock(self) -> float:
        return self.time

    def sleep(self, duration: float) -> None:
        self.time += duration + self.oversleep
        self.oversleep = 0.0

    def send(self, frames: Iterable[Frame]) -> bool:
        self.sent += [(self.time, frame) for frame in frames]
        return self._sends

    def receive(self, timeout: float) -> Frame | None:
        if self._hears:
            self.time += timeout
        return None  # and where it hears nothing it gives up at once

    def flush(self) -> None: ...

    def close(self) -> None:
        self.closed = True


def parts(world: World, kind: str = "cia402") -> Parts:
    bench = profile(DRIVES[kind])
    clock = RealTimeClock(PERIOD, clock=world.clock, sleep=world.sleep)
    return Parts(bench, make_drive(bench.drive), world, clock)


def test_a_stall_is_one_late_tick_and_no_burst():
    """A sleep that is 15.3 ms too long: told once, in full; the next tick has its own deadline."""
    world = World(hears=False)
    rig = parts(world).rig
    began = world.time
    seen = []
    for tick in range(6):
        world.oversleep = 0.0153 if tick == 2 else 0.0
        rig.wait()
        rig.read()
        o = rig.observation()
        seen.append((world.time - began, o.late, o.skipped, rig.telemetry()[-1]))
    after = [
        (0.001, 0.0, 0, 0), (0.002, 0.0, 0, 0), (0.0183, 0.0153, 15, 15),
        (0.019, 0.0, 0, 15), (0.020, 0.0, 0, 15), (0.021, 0.0, 0, 15),
    ]  # fmt: skip
    assert seen == [pytest.approx(one, abs=1e-9) for one in after]


def test_ticks_that_take_too_long_are_seen_to_leave_some_out():
    """1.9 ms each in a loop of 1 ms: some 47 in 100 deadlines."""
    world = World(hears=False)
    rig = parts(world).rig
    skipped = 0
    for _ in range(100):
        rig.wait()
        rig.read()
        skipped += rig.observation().skipped
        world.time += 0.0019
    assert skipped == pytest.approx(90, abs=2)


def farewells(world: World, kind: str) -> list[float]:
    """When each was said, of those that say zero."""
    bench = parts(world, kind)
    bench.rig.close()
    assert world.closed
    assert bench.rig.disabled is None
    zero = 0x205 if kind == "cia402" else 3 << 5 | 0x0E
    said = [(time, frame.data) for time, frame in world.sent if frame.id == zero]
    assert not any(any(data[2:4]) if kind == "cia402" else any(data) for _, data in said)
    return [time for time, _ in said]


@pytest.mark.parametrize("kind", DRIVES)
class TestFarewell:
    def test_a_bus_that_had_an_error_frame_carries_it_all_the_same(self, kind: str):
        world = World()
        world.trouble = "error frames"
        # 50 ms and a heartbeat's period, each 5 ms or a tick more.
        assert 10 <= len(farewells(world, kind)) <= 13

    def test_where_nothing_is_heard_it_is_not_said_all_at_once(self, kind: str):
        world = World(hears=False)
        world.trouble = "cannot receive"
        said = farewells(world, kind)
        assert 10 <= len(said) <= 13
        assert min(b - a for a, b in pairwise(said)) > 0.0045

    def test_where_it_cannot_be_sent_it_is_tried_twice(self, kind: str):
        said = farewells(World(sends=False), kind)
        assert len(said) == 2
        assert said[1] - said[0] == pytest.approx(0.005, abs=1.1e-3)
