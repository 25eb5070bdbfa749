"""An emulated bench as a process of its own: devices on a real bus, a bar and a rider behind them.

It knows nothing of its host but the frames on the bus; what the rider sees of the bicycle comes
from the ride's screen, as a person's would.
"""

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from bikesim.bench.asking import ASK
from bikesim.bench.bus import BusSettings, close_bus, open_bus
from bikesim.bench.bus_errors import bus_fails
from bikesim.bench.database import STEER_COMMAND, message
from bikesim.bench.display import ScreenReader, screen_name
from bikesim.bench.drives import make_drive
from bikesim.bench.frame import Frame, from_message, to_message
from bikesim.bench.mishaps import Mishap, Mishaps
from bikesim.bench.plant import Plant
from bikesim.bench.profile import BenchSettings
from bikesim.experiment.scenario import Scenario
from bikesim.realtime import PRIORITY, real_time

if TYPE_CHECKING:
    import can

QUANTUM = 0.001
"""Of the physics, and between two looks at what is due [s]."""

_STALE = 0.3  # s, without a new picture the ride is over; a host that hangs for less rides on
_MOST_LATE_FRAMES = 12  # between two quanta, of those that came before; some twice as many as come
_MOST_BEHIND = 0.05  # s; more than that is left out


class Emulator:
    """Runs a plant in real time on a bus, which stays its owner's."""

    def __init__(
        self,
        bus: "can.BusABC",
        bench: BenchSettings,
        scenario: Scenario,
        mishaps: Iterable[Mishap] = (),
        watch: Callable[[float, Plant], object] | None = None,
    ) -> None:
        """`scenario` as `bench_scenario` gives it; `watch` is told the time [s] after a quantum."""
        self.plant = Plant(bench, scenario, quantum=QUANTUM)
        self.longest = 0.0
        """That it was behind the time [s]."""
        self.riding_since: float | None = None
        self._bus, self._watch = bus, watch
        self._mishaps = Mishaps(self.plant, mishaps)
        self._screen = ScreenReader(screen_name(bench.bus))
        # On a bus that echoes the devices' own frames come back too.
        self._wanted = make_drive(bench.drive).host_ids | {message(STEER_COMMAND).frame_id}
        self._shown = 0
        self._shown_at = self._read_at = 0.0

    def run_prompt(self, stop: Callable[[], bool]) -> None:
        """As `run`, under real-time scheduling where it is permitted.

        Below the host's: a real bench does not take the host's time either.
        """
        with real_time(PRIORITY - 5):
            self.run(stop)

    def run(self, stop: Callable[[], bool]) -> None:
        """Until it is told to stop."""
        now = passed = time.monotonic()
        while not stop():
            self._listen(passed + QUANTUM)
            now = time.monotonic()
            behind = now - passed
            self.longest = max(self.longest, behind)
            if behind > _MOST_BEHIND:
                passed = now - QUANTUM
            # One, and then the bus again: while it catches up the host's commands must not wait.
            if passed + QUANTUM <= now:
                passed += QUANTUM
                self._advance(passed, now)
        self._screen.close()

    def _advance(self, passed: float, now: float) -> None:
        self._look(now)
        since = self.riding_since
        self._mishaps.happen(None if since is None else now - since)
        self.plant.advance()
        for device in self.plant.devices:
            self._send(device.advance(passed))
        if self._watch is not None:
            self._watch(passed, self.plant)

    def _look(self, now: float) -> None:
        """What the rider sees; his hands go on the bar with the first picture of a ride."""
        seen = self._screen.look()
        if seen is not None and seen[0] != self._shown:
            first = self._shown == 0
            self._shown, self._shown_at = seen[0], now
            if first:
                return  # may be an old ride's last
            if self.riding_since is None:
                self.riding_since = now
            self.plant.show(seen[1])
        elif self.riding_since is not None and now - self._shown_at > _STALE:
            self.riding_since = None
            self.plant.show(None)
        if self.riding_since is None and now - self._read_at > _STALE:
            self._read_at = now
            self.plant.ask(asked=self._screen.alive and ASK in self._screen.words)

    def _listen(self, until: float) -> None:
        """Takes what comes until then; when it is late, all the same some that are there already.

        Not all: while it takes them others come, and the sensors would fall silent.
        """
        late = 0
        while late < _MOST_LATE_FRAMES:
            left = until - time.monotonic()
            late += left <= 0.0
            came = self._bus.recv(max(left, 0.0))
            if came is None:
                return
            frame = from_message(came) if came.arbitration_id in self._wanted else None
            if frame is not None and self._mishaps.hears_host:
                now = time.monotonic()
                for device in self.plant.devices:
                    self._send(device.receive(frame, now))

    def _send(self, frames: Iterable[Frame]) -> None:
        for frame in frames:
            for one in self._mishaps.pass_to_host(frame):
                self._bus.send(to_message(one))


@contextlib.contextmanager
def emulated_bus(settings: BusSettings) -> "Iterator[can.BusABC]":
    """The bus as the devices have it. Raises InputError if there is none, or it fails."""
    bus = open_bus(settings)
    try:
        with bus_fails():
            yield bus
    finally:
        close_bus(bus)
