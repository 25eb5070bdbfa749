"""An emulated bench that its computer gives too little time."""

import time
from collections import deque

import can
import pytest

from bikesim.bench.bus import BusSettings
from bikesim.bench.emulator import QUANTUM, Emulator
from bikesim.bench.frame import Frame, to_message
from bikesim.bench.scenario import bench_scenario
from bikesim.experiment.scenario import Scenario

from .lockstep import DRIVES, profile


class EchoingBus:
    """Gives back what is sent, and has a command of a host each millisecond."""

    def __init__(self) -> None:
        self._queue: deque[can.Message] = deque()
        self._next = time.monotonic()
        self.longest = 0

    def send(self, message: can.Message) -> None:
        self._queue.append(message)

    def recv(self, timeout: float) -> can.Message | None:
        while self._next <= time.monotonic():
            self._next += 0.001
            self._queue.append(to_message(Frame(0x205, bytes(5))))
        self.longest = max(self.longest, len(self._queue))
        if not self._queue:
            time.sleep(timeout)
            return None
        return self._queue.popleft()


@pytest.mark.parametrize("kind", DRIVES)
def test_a_bench_that_is_late_hears_its_host_all_the_same(kind: str):
    """Its physics takes twice the time that it has: it leaves some out, and no command waits long.

    Three or four frames come in a millisecond, its own among them; what waits is what came while it
    did some quanta, not more and more.
    """
    bench = profile(DRIVES[kind], bus={"interface": "virtual", "channel": f"slow {kind}"})
    assert isinstance(bench.bus, BusSettings)
    bus = EchoingBus()
    emulator = Emulator(bus, bench, bench_scenario(bench, Scenario()))  # pyright: ignore[reportArgumentType]
    advance, quanta = emulator.plant.advance, 0

    def slowly() -> None:
        nonlocal quanta
        quanta += 1
        time.sleep(2 * QUANTUM)
        advance()

    emulator.plant.advance = slowly
    end = time.monotonic() + 0.5
    emulator.run(lambda: time.monotonic() > end)
    assert quanta > 50
    assert bus.longest < 100
