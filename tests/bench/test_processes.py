"""Once with real processes and the wall clock: a host over udp_multicast, its bench here."""

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest

from bikesim.bench.display import ScreenReader, screen_name
from bikesim.bench.mishaps import Mishap
from bikesim.bench.profile import BenchSettings, load_bench
from bikesim.bench.scenario import profile_of
from bikesim.experiment.ride_again import ride_again
from bikesim.record.reader import open_run

from .processes import WATCHDOG, Bench, written


@pytest.fixture(params=["cia402-emulated", "odrive-emulated"])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return written(request.param, tmp_path)


# Processes that begin, and wait for each other.
pytestmark = [pytest.mark.slow, pytest.mark.real_time]


def uncommissioned(path: Path) -> Path:
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if "commissioned" not in line))
    return path


def looked_at(path: Path) -> tuple[subprocess.CompletedProcess[str], dict[str, bool]]:
    checked = Bench(path).until_in_time("check", str(path), "--pulse")
    checks = json.loads(checked.stdout)["checks"] if checked.stdout else []
    return checked, {one["what"]: one["good"] for one in checks}


def test_checked(tmp_path: Path):
    path = uncommissioned(written("cia402-emulated", tmp_path))
    checked, found = looked_at(path)
    for _ in range(2):  # its short pulse has no patience with a machine that is busy elsewhere
        if not found.get("commissioning pulse"):
            checked, found = looked_at(path)
    assert found.get("commissioning pulse"), checked.stdout + checked.stderr
    assert found["drive, at the end"]
    # Frames may be late here; all else must be well.
    late = ("lost", "longest pause", "its clock", "frames of 0x110")
    wrong = [what for what, good in found.items() if not good and not what.endswith(late)]
    assert not wrong, checked.stdout
    good = all(found.values())
    assert checked.returncode == (0 if good else 1)
    assert ("commissioned = " in path.read_text()) == good


def test_commissioned_ridden_and_looked_at_again(path: Path):
    bench = Bench(uncommissioned(path))
    ridden = bench.until_in_time(
        "run", str(path), "--pulse", "--duration", "1.5", "--speed", "3.5", "-o", "r.h5", "--json",
        "--report", "--set", "start.roll_deg=1",
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

    ended = bench.until_in_time(
        "run", str(path), "--duration", "20", "--set", "start.roll_deg=1", "-o", "r.h5", do=kill
    )
    assert ended.returncode == -signal.SIGKILL
    *_, (_, at_the_kill) = (one for one in bench.torques if one[0] <= killed[0])
    assert at_the_kill != 0.0
    last = max(now for now, torque in bench.torques if torque != 0.0)
    # What it had sent before waits for the emulator as long as that is behind.
    assert 0.0 < last - killed[0] < WATCHDOG + 0.02 + bench.emulator.longest
    assert open_run(path.parent / "r.h5").ticks > 300
    ScreenReader(screen_name(bench.settings.bus)).close()


@pytest.mark.parametrize(
    ("number", "name"), [(signal.SIGINT, "cia402-emulated"), (signal.SIGTERM, "odrive-emulated")]
)
def test_a_signal_ramps_out(tmp_path: Path, number: signal.Signals, name: str):
    bench = Bench(written(name, tmp_path))
    sent: list[float] = []

    def stop(host: subprocess.Popen[str], since: float) -> None:
        if since > 0.7 and not sent:
            sent.append(since)
            host.send_signal(number)

    ended = bench.until_in_time("run", str(bench.path), "--duration", "20", "-o", "r.h5", do=stop)
    assert ended.returncode == 0, ended.stderr
    run = open_run(tmp_path / "r.h5")
    assert run.ending is not None
    assert run.ending.reason == "interrupted"
    assert bench.torques[-1][1] == 0.0
    sent_torque = run.channel("sent_torque")
    assert sent_torque[-1] == 0.0


def test_a_mishap_is_a_fault_with_its_name(tmp_path: Path):
    """The torque is zero some ticks later, by the emulator's own clock: no ramp, no watchdog."""
    bench = Bench(written("cia402-emulated", tmp_path), Mishap(kind="estop", time=0.6))
    began: list[float] = []

    def note(host: subprocess.Popen[str], since: float) -> None:
        began.append(time.monotonic() - since)

    ended = bench.until_in_time(
        "run", str(bench.path), "--duration", "20", "--set", "start.roll_deg=3", "-o", "r.h5",
        do=note,
    )  # fmt: skip
    assert ended.returncode == 2
    assert "fault 21: emergency stop" in ended.stderr
    assert ended.stderr.count("\n") == 1
    run = open_run(tmp_path / "r.h5")
    assert run.ending is not None
    assert run.ending.reason.startswith("fault 21")
    assert run.channel("fault")[-1] == 21
    happened = began[-1] + 0.6
    *_, (_, before) = (one for one in bench.torques if one[0] < happened)
    assert before != 0.0
    last = max(now for now, torque in bench.torques if torque != 0.0)
    assert last - happened < 0.05 + bench.emulator.longest
    assert bench.torques[-1][1] == 0.0


def test_a_profile_is_written_whole(tmp_path: Path):
    assert isinstance(load_bench(str(written("odrive-emulated", tmp_path))), BenchSettings)
