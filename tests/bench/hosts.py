"""Rides of one host process, one after the other, on emulated benches in this process."""

import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bikesim.bench.cia402 import State
from bikesim.bench.display import ScreenReader, screen_name
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.mishaps import Mishap
from bikesim.bench.odrive import AxisState
from bikesim.bench.plant import Plant
from bikesim.bench.profile import BenchSettings
from bikesim.experiment.scenario import Scenario
from bikesim.realtime import PRIORITY, real_time
from bikesim.record.reader import Run, open_run
from bikesim.rider.settings import RiderSettings

from .processes import NO_TIME, Bench

AT = 0.2
"""Of the ride, when it goes wrong [s]."""

PATIENCE = 30.0  # s, for a ride


@dataclass(frozen=True)
class Trick:
    """What the host does to itself from a time of the ride on [s]; see host.py."""

    name: str = ""
    time: float = AT


class Host:
    """Begun at the first order, and again where it has ended."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None

    def order(self, arguments: list[str], trick: Trick) -> None:
        """A command; its answer is waited for before the next one."""
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(Path(__file__).with_name("host.py"))],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
            )
        order = {"arguments": arguments, "trick": trick.name, "time": trick.time}
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(order).encode() + b"\n")
        self._process.stdin.flush()

    @property
    def has_answered(self) -> bool:
        assert self._process is not None
        assert self._process.stdout is not None
        return bool(select.select([self._process.stdout], (), (), 0)[0])

    def answer(self) -> dict[str, Any]:
        """Status, out and err."""
        assert self._process is not None
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line, f"the host process ended: {self._process.wait()}"
        return json.loads(line)

    def hang(self) -> None:
        """Until it goes on."""
        self._signal(signal.SIGSTOP)

    def go_on(self) -> None:
        self._signal(signal.SIGCONT)

    def kill(self) -> None:
        """It then has answered, nothing."""
        self._signal(signal.SIGKILL)

    def end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()

    def _signal(self, number: signal.Signals) -> None:
        assert self._process is not None
        os.kill(self._process.pid, number)


class Hang:
    """Stops the host AT a time, for so long [s], or until the drive has let go."""

    def __init__(self, duration: float | None = None) -> None:
        self._duration = duration
        self._began: float | None = None
        self._let_go: float | None = None
        self._over = False

    def __call__(self, host: Host, since: float, torque: float) -> None:
        """At a time of the ride [s]."""
        if self._began is None:
            if since >= AT:
                self._began = since
                host.hang()
            return
        if self._let_go is None and torque == 0.0:
            self._let_go = since
        until = self._let_go if self._duration is None else self._began + self._duration
        if not self._over and until is not None and since > until:
            self._over = True
            host.go_on()


@dataclass(frozen=True)
class Ridden:
    """A ride as it was seen from outside: of its command, on the display, at the drive."""

    status: int
    out: str
    err: str
    words: tuple[str, ...]
    torques: list[tuple[float, float]] = field(repr=False)
    """Times of the ride [s], torques of the drive [N m] at the steer axis."""
    enabled: bool
    """Whether the drive was, at the end."""
    behind: float
    """That the emulated bench was behind the time since the ride began [s]; at most."""
    record: Path

    @property
    def largest_torque(self) -> float:
        return max(abs(torque) for _, torque in self.torques)

    @property
    def zero_after(self) -> float:
        """When the drive gave a torque for the last time [s]."""
        return max(time for time, torque in self.torques if torque != 0.0)

    def torque(self, time: float) -> float:
        """Of the drive, at a time of the ride [s]."""
        return next(torque for at, torque in reversed(self.torques) if at <= time)

    def run(self) -> Run:
        return open_run(self.record)


def ridden(
    host: Host,
    path: Path,
    *arguments: str,
    mishaps: tuple[Mishap, ...] = (),
    real: BenchSettings | None = None,
    trick: Trick = Trick(),
    hang: Callable[[], Hang] | None = None,
) -> Ridden:
    """`bikesim bench run PATH`, as often as this machine gives it no time before it rides.

    `real`: what the bench is; default: what its profile says.
    """

    def once() -> Ridden:
        return _Once(host, path, mishaps, real, hang and hang()).ride(arguments, trick)

    seen = once()
    for _ in range(2):
        if any(words in seen.err for words in NO_TIME):
            seen = once()
    return seen


class _Once(Bench):
    scenario = Scenario(rider=RiderSettings(name="hands-off"))

    def __init__(
        self,
        host: Host,
        path: Path,
        mishaps: tuple[Mishap, ...],
        real: BenchSettings | None,
        hang: Hang | None,
    ) -> None:
        super().__init__(path, *mishaps)
        self._screen = ScreenReader(screen_name(self.settings.bus))
        self.settings = real or self.settings
        self._host, self._hang = host, hang
        self._words: list[str] = []
        self._rode: float | None = None

    def ride(self, arguments: tuple[str, ...], trick: Trick) -> Ridden:
        record = self.path.parent / "r.h5"
        command = ["bench", "run", str(self.path), "-o", str(record), "--force", *arguments]
        deadline = time.monotonic() + PATIENCE
        with self._emulated() as emulator, real_time(PRIORITY - 5):
            self._host.order(command, trick)

            def over() -> bool:
                self._look()
                if time.monotonic() > deadline:
                    self._host.kill()
                return self._host.has_answered

            emulator.run(over)
            answer = self._host.answer()
            self._linger(emulator, 0.1)
        self._screen.close()
        zero = self._rode or 0.0
        return Ridden(
            **answer,
            words=tuple(self._words),
            torques=[(now - zero, torque) for now, torque in self.torques],
            enabled=_enabled(emulator.plant),
            behind=emulator.longest,
            record=record,
        )

    def _look(self) -> None:
        if self._rode is None and self.emulator.riding_since is not None:
            self._rode, self.emulator.longest = self.emulator.riding_since, 0.0
        self._screen.look()
        words = self._screen.words
        if words and words not in self._words[-1:]:
            self._words.append(words)
        if self._hang is not None and self._rode is not None:
            self._hang(self._host, time.monotonic() - self._rode, self.torques[-1][1])


def _enabled(plant: Plant) -> bool:
    if isinstance(plant.drive, EmulatedDrive):
        return plant.drive.state is State.OPERATION_ENABLED
    assert isinstance(plant.drive, EmulatedODrive)
    return plant.drive.state is AxisState.CLOSED_LOOP_CONTROL
