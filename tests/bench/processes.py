"""Hosts as processes of their own, and the emulated bench that they ride in this process."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import tomli_w

from bikesim.bench.bus import BusSettings
from bikesim.bench.emulator import Emulator, emulated_bus
from bikesim.bench.mishaps import Mishap
from bikesim.bench.plant import Plant
from bikesim.bench.profile import load_bench
from bikesim.bench.scenario import bench_scenario
from bikesim.experiment.scenario import Scenario
from bikesim.realtime import PRIORITY, real_time

WATCHDOG = 0.15  # s


def written(
    name: str,
    folder: Path,
    bus: BusSettings | None = None,
    *,
    thresholds: dict[str, Any] | None = None,
    limits: dict[str, Any] | None = None,
    watchdog: float = WATCHDOG,
    **bar: Any,
) -> Path:
    """A profile that ships, on a port of this process's own or another bus, with other figures."""
    settings = load_bench(name)
    port = {"port": 40_000 + os.getpid() % 20_000}
    bus = bus or settings.bus.model_copy(update={"arguments": port})
    # What is asked here is what happens, not how soon, on a machine that others use too.
    patient = settings.thresholds.model_copy(
        update={
            "hold_age": 0.05, "ramp_age": 0.2, "zero_age": 0.4, "drive_age": 0.4,
            "drive_heartbeats": 20.0, "follow_time": 0.4, "slip_time": 0.4, "late_most": WATCHDOG,
            "late": 0.1, "skipped_share": 0.9, "late_ticks": 400,
            "bad_frames": 10, "frozen_frames": 10, **(thresholds or {}),
        }
    )  # fmt: skip
    timeout = "watchdog_timeout" if settings.drive.kind == "odrive" else "heartbeat_timeout"
    drive = settings.drive.model_copy(update={timeout: watchdog})
    changed = settings.model_copy(
        update={
            "bus": bus,
            "bar": settings.bar.model_copy(update=bar),
            "thresholds": patient,
            "limits": settings.limits.model_copy(update=limits or {}),
            "drive": drive,
            "wheel": None,
        }
    )
    changed = changed.model_copy(update={"commissioned": changed.commissioning})
    file = folder / "bench.toml"
    file.write_text(tomli_w.dumps(changed.model_dump(mode="json", exclude_none=True)))
    return file


NO_TIME = ("is still enabled", "nobody answers", "at rest, before any torque")


class Bench:
    """An emulated bench in this process, and hosts as processes beside it."""

    scenario = Scenario()
    """Of it the rider."""

    def __init__(self, path: Path, *mishaps: Mishap, bus: BusSettings | None = None) -> None:
        """`bus`: as the bench has it; default: as its host."""
        self.path = path
        self.settings = load_bench(str(path))
        self.bus = bus or self.settings.bus
        self.mishaps = mishaps
        self.torques: list[tuple[float, float]] = []
        self.angles: list[tuple[float, float]] = []

    @property
    def largest_torque(self) -> float:
        return self.emulator.plant.largest_torque

    def with_host(
        self, *arguments: str, do: Callable[[subprocess.Popen[str], float], object] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """`do` is told how long the ride has lasted [s], while it does."""
        command = [sys.executable, "-m", "bikesim", "bench", *arguments]
        with self._emulated() as emulator, subprocess.Popen(
            command, cwd=self.path.parent, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as host:  # fmt: skip
            deadline = time.monotonic() + 60

            def over() -> bool:
                since = emulator.riding_since
                if do is not None and since is not None:
                    do(host, time.monotonic() - since)
                if time.monotonic() > deadline:
                    host.kill()
                return host.poll() is not None

            with real_time(PRIORITY - 5):
                emulator.run(over)
                out, err = host.communicate()
                self._linger(emulator)
        return subprocess.CompletedProcess(command, host.returncode, out, err)

    def until_in_time(
        self, *arguments: str, do: Callable[[subprocess.Popen[str], float], object] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Up to three times, where this machine gave it no time before it rode."""
        again = "--force" if arguments[0] == "run" else "--json"
        ended = self.with_host(*arguments, again, do=do)
        for _ in range(2):
            if not any(words in ended.stdout + ended.stderr for words in NO_TIME):
                break
            ended = self.with_host(*arguments, again, do=do)
        return ended

    def _linger(self, emulator: Emulator, duration: float = 0.2) -> None:
        end = time.monotonic() + duration
        emulator.run(lambda: time.monotonic() > end)

    @contextmanager
    def _emulated(self) -> Iterator[Emulator]:
        scenario = bench_scenario(self.settings, self.scenario)
        with emulated_bus(self.bus) as bus:
            self.emulator = Emulator(bus, self.settings, scenario, self.mishaps, self._watch)
            yield self.emulator

    def _watch(self, now: float, plant: Plant) -> None:
        self.torques.append((now, plant.torque))
        self.angles.append((now, plant.steer))
