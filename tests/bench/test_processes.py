"""Once with real processes and the wall clock: a host over udp_multicast, its bench here."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import tomli_w

from bikesim.bench.display import ScreenReader, screen_name
from bikesim.bench.emulator import Emulator, emulated_bus
from bikesim.bench.mishaps import Mishap
from bikesim.bench.plant import Plant
from bikesim.bench.profile import BenchSettings, load_bench
from bikesim.bench.scenario import bench_scenario, profile_of
from bikesim.experiment.ride_again import ride_again
from bikesim.experiment.scenario import Scenario
from bikesim.realtime import PRIORITY, real_time
from bikesim.record.reader import open_run

WATCHDOG = 0.15  # s


@pytest.fixture(params=["cia402-emulated", "odrive-emulated"])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return written(request.param, tmp_path)


def written(name: str, folder: Path, **more: str) -> Path:
    """A profile that ships, on a port of this process's own."""
    settings = load_bench(name)
    port = {"port": 40_000 + os.getpid() % 20_000}
    bus = settings.bus.model_copy(update={"arguments": port})
    # What is asked here is what happens, not how soon, on a machine that others use too.
    thresholds = settings.thresholds.model_copy(
        update={
            "hold_age": 0.05, "ramp_age": 0.2, "zero_age": 0.4, "drive_age": 0.4,
            "drive_heartbeats": 20.0, "follow_time": 0.4, "slip_time": 0.4, "late_most": 0.4,
            "late_ticks": 400, "bad_frames": 10, "frozen_frames": 10,
        }
    )  # fmt: skip
    watchdog = "watchdog_timeout" if settings.drive.kind == "odrive" else "heartbeat_timeout"
    drive = settings.drive.model_copy(update={watchdog: WATCHDOG})
    changed = settings.model_copy(
        update={"bus": bus, "thresholds": thresholds, "drive": drive, "wheel": None, **more}
    )
    changed = changed.model_copy(update={"commissioned": changed.commissioning})
    file = folder / "bench.toml"
    file.write_text(tomli_w.dumps(changed.model_dump(mode="json", exclude_none=True)))
    return file


class Bench:
    """An emulated bench in this process, and hosts as processes beside it."""

    def __init__(self, path: Path, *mishaps: Mishap) -> None:
        self.path = path
        self.settings = load_bench(str(path))
        self.mishaps = mishaps
        self.torques: list[tuple[float, float]] = []

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

    def until_in_time(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Up to three times, where this machine gave it no time while its watchdog was proven."""
        again = "--force" if arguments[0] == "run" else "--json"
        ended = self.with_host(*arguments, again)
        for _ in range(2):
            if "is still enabled" not in ended.stdout + ended.stderr:
                break
            ended = self.with_host(*arguments, again)
        return ended

    def _linger(self, emulator: Emulator) -> None:
        end = time.monotonic() + 0.2
        emulator.run(lambda: time.monotonic() > end)

    @contextmanager
    def _emulated(self) -> Iterator[Emulator]:
        scenario = bench_scenario(self.settings, Scenario())
        with emulated_bus(self.settings) as bus:
            self.emulator = Emulator(bus, self.settings, scenario, self.mishaps, self._watch)
            yield self.emulator

    def _watch(self, now: float, plant: Plant) -> None:
        self.torques.append((now, plant.torque))


# Processes that begin, and wait for each other.
pytestmark = pytest.mark.slow


def test_commissioned_ridden_and_looked_at_again(path: Path):
    bench = Bench(path)
    text = path.read_text()
    path.write_text("".join(line for line in text.splitlines(True) if "commissioned" not in line))
    refused = bench.with_host("run", str(path), "--duration", "1")
    assert refused.returncode == 2
    assert "never passed the commissioning pulse" in refused.stderr
    checked = bench.until_in_time("check", str(path), "--pulse")
    found = {one["what"]: one["good"] for one in json.loads(checked.stdout)["checks"]}
    assert checked.returncode == (0 if all(found.values()) else 1)
    # Frames may be late here; all else must be well.
    late = ("lost", "longest pause", "its clock", "frames of 0x110")
    wrong = [what for what, good in found.items() if not good and not what.endswith(late)]
    assert not wrong, checked.stdout
    if checked.returncode:
        path.write_text(text)
    ridden = bench.until_in_time(
        "run", str(path), "--duration", "1.5", "--speed", "3.5", "-o", "r.h5", "--json", "--report",
        "--set", "start.roll_deg=1",
    )  # fmt: skip
    assert ridden.returncode == 0, ridden.stderr
    summary = json.loads(ridden.stdout)
    assert summary["reason"] == "end of run"
    assert summary["timing"]["ticks"] == summary["ticks"]
    assert 0.05 < bench.largest_torque < 3.5
    run = open_run(path.parent / "r.h5")
    assert (run.rig, run.rider, run.complete) == ("bench", "person", True)
    assert run.time[-1] == pytest.approx(1.6, abs=0.1)
    assert ride_again(run).feedback_torque == 0.0
    assert "udp_multicast" in profile_of(run.scenario)
    for name in ("r.blf", "r-timing.png"):
        assert (path.parent / name).stat().st_size > 1000


def test_kill_9_of_the_host(path: Path):
    bench = Bench(path)
    killed: list[float] = []

    def kill(host: subprocess.Popen[str], since: float) -> None:
        if since > 1.5 and not killed:
            killed.append(time.monotonic())
            host.kill()

    ended = bench.with_host(
        "run", str(path), "--duration", "20", "--set", "start.roll_deg=1", "-o", "r.h5", do=kill
    )
    assert ended.returncode == -signal.SIGKILL
    before = [torque for now, torque in bench.torques if killed[0] - 0.1 < now < killed[0]]
    assert max(map(abs, before)) > 0.0
    last = max(now for now, torque in bench.torques if torque != 0.0)
    assert last - killed[0] < WATCHDOG + 0.1
    assert open_run(path.parent / "r.h5").ticks > 300
    ScreenReader(screen_name(bench.settings.bus)).close()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ramps_out(tmp_path: Path, number: signal.Signals):
    bench = Bench(written("cia402-emulated", tmp_path))
    sent: list[float] = []

    def stop(host: subprocess.Popen[str], since: float) -> None:
        if since > 0.7 and not sent:
            sent.append(since)
            host.send_signal(number)

    ended = bench.with_host("run", str(bench.path), "--duration", "20", "-o", "r.h5", do=stop)
    assert ended.returncode == 0, ended.stderr
    run = open_run(tmp_path / "r.h5")
    assert run.ending is not None
    assert run.ending.reason == "interrupted"
    assert bench.torques[-1][1] == 0.0
    sent_torque = run.channel("sent_torque")
    assert sent_torque[-1] == 0.0


def test_a_mishap_is_a_fault_with_its_name(tmp_path: Path):
    """Its reaction within a few periods, by the emulator's own clock."""
    bench = Bench(written("cia402-emulated", tmp_path), Mishap(kind="estop", time=0.6))
    ended = bench.with_host("run", str(bench.path), "--duration", "20", "-o", "r.h5")
    print(ended.stdout)
    assert ended.returncode == 2
    assert "fault 21: emergency stop" in ended.stderr
    assert ended.stderr.count("\n") == 1
    run = open_run(tmp_path / "r.h5")
    assert run.ending is not None
    assert run.ending.reason.startswith("fault 21")
    assert run.channel("fault")[-1] == 21
    assert bench.torques[-1][1] == 0.0


def test_units_that_contradict_the_nameplate(tmp_path: Path):
    path = written("cia402-emulated", tmp_path)
    bench = Bench(path)
    path.write_text(path.read_text().replace('"uNm"', '"mNm"'))
    ended = bench.with_host("run", str(path), "--uncommissioned")
    assert ended.returncode == 2
    assert "its unit is uNm, set torque_unit" in ended.stderr
    assert ended.stderr.count("\n") == 1
    assert bench.largest_torque == 0.0


def test_a_profile_is_written_whole(tmp_path: Path):
    assert isinstance(load_bench(str(written("odrive-emulated", tmp_path))), BenchSettings)
