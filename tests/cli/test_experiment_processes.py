"""bikesim experiment: what only real processes can show."""

import json
import os
import resource
import signal
import time
from pathlib import Path

import pytest

from .experiments import MANY, rows

KILLER = """
import os
import signal
from pathlib import Path
import numpy as np

class Killer:
    def __init__(self, setting, *, often=1.0):
        self.often = often

    def intend(self, steer, steer_rate, seen):
        marks = Path(__file__).with_name("marks")
        marks.mkdir(exist_ok=True)
        # Not where he is tried, three at once and one by one.
        if np.size(steer) == 2 and len(list(marks.iterdir())) < self.often:
            (marks / str(os.getpid())).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return 0 * steer
"""

OPTIONS = ("experiment", "e.toml", "--no-report", "--jobs", 2)


@pytest.fixture
def riding(process, file, tmp_path: Path):
    """One in the middle of its batches."""
    file(MANY)
    begun = process(*OPTIONS)
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob("runs/e/parts/*.parquet")):
        assert begun.poll() is None, begun.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    yield begun
    if begun.poll() is None:
        begun.kill()
    begun.communicate()


def test_a_signal_ends_it_and_what_was_computed_stays(riding, tmp_path: Path):
    riding.send_signal(signal.SIGINT)
    out, err = riding.communicate(timeout=60)
    assert riding.returncode in (130, -signal.SIGINT)
    done = rows(tmp_path / "runs/e")
    assert 0 < len(done) < 40
    last = err.splitlines()[-1]
    assert last == (
        f"bikesim: interrupted; {len(done)} of 40 runs are kept in runs/e, the same command goes on"
    )
    assert "law=paper" in out


@pytest.mark.slow
@pytest.mark.parametrize("crew", ["--jobs", "--workers"])
def test_a_ctrl_c_is_for_all_of_its_processes_and_one_line(process, file, tmp_path: Path, crew):
    """A terminal signals all that are in its foreground."""
    file(MANY)
    command = ("experiment", "e.toml", "--no-report", crew, 2)
    begun = process(*command, start_new_session=True)
    try:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("runs/e/parts/*.parquet")):
            assert begun.poll() is None, begun.communicate()
            assert time.monotonic() < deadline
            time.sleep(0.01)
        os.killpg(begun.pid, signal.SIGINT)
        _, err = begun.communicate(timeout=60)
    finally:
        if begun.poll() is None:
            begun.kill()
            begun.communicate()
    assert begun.returncode in (130, -signal.SIGINT)
    done = rows(tmp_path / "runs/e")
    assert 0 < len(done) < 40
    announced, ended = err.splitlines()
    assert announced.startswith("2 conditions x 20 seeds: 40 runs in 20 batches on 2 workers")
    assert ended == (
        f"bikesim: interrupted; {len(done)} of 40 runs are kept in runs/e, the same command goes on"
    )


def test_killed_its_workers_end_and_it_goes_on(riding, process, cli, tmp_path: Path):
    workers = children(riding.pid)
    assert len(workers) == 2
    riding.kill()
    riding.wait(60)
    deadline = time.monotonic() + 30
    while any(alive(pid) for pid in workers):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    again = process(*OPTIONS)
    _, err = again.communicate(timeout=60)
    assert again.returncode == 0
    assert " of 40 runs in " in err
    undisturbed = ("--no-report", "--batch-size", 512, "-o", "undisturbed")
    assert cli("experiment", "e.toml", *undisturbed).status == 0
    assert rows(tmp_path / "runs/e") == rows(tmp_path / "undisturbed")


def test_a_full_disk_is_one_line(riding, tmp_path: Path):
    limit = 1000, resource.RLIM_INFINITY
    resource.prlimit(riding.pid, resource.RLIMIT_FSIZE, limit)
    out, err = riding.communicate(timeout=60)
    assert (riding.returncode, out) == (2, "")
    last = err.splitlines()[-1]
    assert last.startswith("bikesim: runs/e/")
    assert "cannot be written: file too large" in last
    assert "Traceback" not in err
    assert list(tmp_path.glob("runs/e/parts/*.parquet"))


@pytest.mark.parametrize("crew", ["--jobs", pytest.param("--workers", marks=pytest.mark.slow)])
def test_a_worker_that_dies_costs_nothing(process, file, tmp_path: Path, crew):
    file(KILLER, "killer.py")
    file("seeds = 2\nscenario = { duration = 0.1, rider.name = 'killer.py:Killer' }")
    begun = process("experiment", "e.toml", "--no-report", crew, 1, "--json")
    out, err = begun.communicate(timeout=60)
    assert (begun.returncode, err) == (0, "")
    assert json.loads(out)["runs"] == 2
    assert len(list((tmp_path / "marks").iterdir())) == 1


def test_a_batch_that_kills_each_worker_is_one_line(process, file, tmp_path: Path):
    file(KILLER, "killer.py")
    file(
        "seeds = 2\n[scenario]\nduration = 0.1\n[scenario.rider]\n"
        "name = 'killer.py:Killer'\nfigures = { often = 9.0 }\n"
    )
    begun = process("experiment", "e.toml", "--no-report", "--jobs", 1, "--json")
    out, err = begun.communicate(timeout=60)
    assert (begun.returncode, out) == (2, "")
    assert err.startswith("bikesim: batch 1 (2 runs, the first 1-1): its worker ended twice")
    assert err.count("\n") == 1
    assert len(list((tmp_path / "marks").iterdir())) == 2


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
