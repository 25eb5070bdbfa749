"""A ride with `--display`, by real processes: the window, and what becomes of it, is no harm."""

import os
import signal
import subprocess
from pathlib import Path

import pytest

from bikesim.record.reader import open_run

from ..view.live.screen import monitor
from .processes import Bench, written

# Processes that begin, and wait for each other.
pytestmark = [pytest.mark.slow, pytest.mark.real_time]


def displays_of(host: int) -> list[int]:
    children = Path(f"/proc/{host}/task/{host}/children").read_text().split()
    return [pid for pid in map(int, children) if b"display" in command_of(pid)]


def command_of(pid: int) -> list[bytes]:
    return Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")


def test_a_display_that_is_killed_is_no_harm_to_the_ride(tmp_path: Path, monkeypatch):
    bench = Bench(written("cia402-emulated", tmp_path))
    killed: list[int] = []
    light: list[float] = []
    with monitor(tmp_path) as at:
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        monkeypatch.setenv("XDG_SESSION_TYPE", "x11")
        monkeypatch.setenv("DISPLAY", at.display)

        def kill(host: subprocess.Popen[str], since: float) -> None:
            if since > 0.5 and not killed:
                light.append(float(at.picture().mean()))
                killed.extend(displays_of(host.pid))
                os.kill(killed[0], signal.SIGKILL)

        ridden = bench.until_in_time(
            "run", str(bench.path), "--duration", "2", "--display", "-o", "r.h5", do=kill
        )
    assert (ridden.returncode, ridden.stderr) == (0, "")
    assert "display  ready: " in ridden.stdout
    assert len(killed) == 1
    assert light[0] > 80  # the road by day, not a sheet that says to wait
    run = open_run(tmp_path / "r.h5")
    assert run.ending is not None
    assert run.ending.reason == "end of run"


def test_where_nothing_can_be_displayed_the_ride_goes_on(tmp_path: Path, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    bench = Bench(written("cia402-emulated", tmp_path))
    ridden = bench.until_in_time(
        "run", str(bench.path), "--duration", "1", "--display", "-o", "r.h5"
    )
    assert (ridden.returncode, ridden.stderr) == (0, "")
    first = ridden.stdout.splitlines()[0]
    assert first.startswith("display  none, the ride goes on without: no window can be opened here")
    assert open_run(tmp_path / "r.h5").ticks > 500
