"""bikesim experiment"""

import json
import os
import resource
import signal
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from bikesim.experiment.study.columns import PROVENANCE

# Some seconds in twenty batches.
MANY = """
seeds = 20
batch_size = 2
[scenario]
duration = 1.0
[factors]
law = ["paper", "off"]
"""
SMALL = """
title = "Haptics, very short"
seeds = 2
keep = "first"
[scenario]
duration = 0.2
[factors]
law = ["paper", "off"]
"""
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


@pytest.fixture
def file(tmp_path: Path):
    def write(text: str, name: str = "e.toml") -> str:
        (tmp_path / name).write_text(text)
        return name

    return write


def rows(folder: Path) -> list[dict[str, str]]:
    """The table but for who computed it."""
    table = pq.read_table(folder / "results.parquet").drop_columns(list(PROVENANCE))
    # What is not defined equals itself as text only.
    return [{name: repr(value) for name, value in row.items()} for row in table.to_pylist()]


def test_medians_say_of_which_runs_they_are(cli, file, tmp_path: Path):
    """With haptics off all fall: the duration is theirs, and ends a tick after the fall."""
    text = (
        SMALL.replace("duration = 0.2", "duration = 10.0")
        + """
[report]
metrics = ["fall_time", "duration", "roll_rms"]
"""
    )
    said = cli("experiment", file(text), "--jobs", 1, "--no-report")
    assert (
        "medians of the runs that came to their end; duration: median of all runs; fall time: "
        "median by Kaplan-Meier, of all runs; falls with Wilson's interval"
    ) in said.out.splitlines()
    told = cli("experiment", "e.toml", "--jobs", 1, "--no-report", "--json").json
    table = pq.read_table(tmp_path / "runs/e" / "results.parquet").to_pandas()
    off = table[table["law"] == "off"]
    assert off["fell"].tolist() == [1, 1]
    medians = told["conditions"][1]["medians"]
    # Of two the first time by which half have fallen.
    assert medians["fall_time"] == off["fall_time"].min() < off["duration"].min()
    assert medians["duration"] == pytest.approx(off["duration"].mean())


def test_it_tells_what_came_of_it_and_again_computes_nothing(cli, file, tmp_path: Path):
    said = cli("experiment", file(SMALL), "--jobs", 1)
    assert said.status == 0
    assert said.err == (
        "2 conditions x 2 seeds: 4 runs in 2 batches on 1 worker: a few seconds at most\n"
    )
    lines = said.out.splitlines()
    assert lines[0] == "Haptics, very short"
    assert lines[1].split()[:5] == ["condition", "runs", "falls", "%", "(95"]
    assert lines[3].split()[:6] == ["law=paper", "2", "0", "0", "to", "66"]
    assert lines[-2:] == ["results runs/e/results.parquet, .csv", "report  runs/e/report.html"]
    results = tmp_path / "runs/e"
    assert (results / "report.html").stat().st_size > 10_000
    assert len(rows(results)) == 4
    kept = {path.name for path in (results / "records").iterdir()}
    assert kept == {"1-law=paper-seed1.h5", "2-law=off-seed1.h5"}
    before = (results / "results.csv").read_bytes()
    again = cli("experiment", "e.toml", "--jobs", 1, "--no-report")
    assert (again.status, again.err) == (0, "")
    assert again.out.splitlines() == lines[:-1]
    assert (results / "results.csv").read_bytes() == before


def test_json_has_the_conditions_and_their_falls(cli, file):
    told = cli("experiment", file(SMALL), "--jobs", 1, "--no-report", "--json").json
    assert (told["runs"], told["runs_planned"], told["report"]) == (4, 4, None)
    assert [one["factors"] for one in told["conditions"]] == [{"law": "paper"}, {"law": "off"}]
    assert [(one["runs"], one["falls"]) for one in told["conditions"]] == [(2, 0), (2, 0)]


class TestDryRun:
    def test_says_what_would_be_and_leaves_nothing(self, cli, file, tmp_path: Path):
        said = cli("experiment", file(MANY), "--dry-run", "--jobs", 2)
        assert said.status == 0
        assert [line.split()[0] for line in said.out.splitlines()[2:4]] == ["law=paper", "law=off"]
        assert "2 conditions x 20 seeds: 40 runs in 20 batches" in said.out
        assert said.out.splitlines()[-1].startswith("about a few seconds on 2 workers")
        assert [path.name for path in tmp_path.iterdir()] == ["e.toml"]

    def test_as_json(self, cli, file):
        told = cli("experiment", file(MANY), "--dry-run", "--json", "--batch-size", 40).json
        assert (told["runs"], told["batches"], len(told["conditions"])) == (40, 2, 2)
        assert 0 < told["estimate_s"] < 60


class TestRefused:
    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (("--jobs", 0), "--jobs 0: must be at least 1"),
            (("--jobs", 1, "--workers", 2), "--jobs, --workers, --scheduler: one of them at a"),
            (("--batch-size", 0), "--batch-size 0: must be at least 1"),
            (("--scheduler", "x"), "--scheduler x: no Dask scheduler answers"),
        ],
    )
    def test_wrong_options(self, refusal, file, options, message: str):
        assert message in refusal("experiment", file(SMALL), *options, "--json")

    def test_no_such_experiment(self, refusal):
        assert "experiment gone.toml: no such file" in refusal("experiment", "gone.toml")
        assert "unknown experiment 'gone'" in refusal("experiment", "gone")

    def test_what_is_wrong_in_the_file_names_it(self, refusal, file):
        told = refusal("experiment", file(f"{SMALL}speed = [99]\n"))
        assert "e.toml" in told
        assert "factors.speed, level 99: speed = 99: must be at least 0 and at most 30" in told

    def test_what_only_the_parts_find(self, refusal, file, tmp_path: Path):
        told = refusal("experiment", file(f"{SMALL}bicycle = ['benchmark', 'gone.toml']\n"))
        assert "condition 'law=paper, bicycle=gone.toml': " in told
        assert not (tmp_path / "runs").exists()

    def test_too_many_runs_with_how_long_they_would_take(self, refusal, file):
        told = refusal("experiment", file("seeds = 5_000_000\nscenario.duration = 60"))
        assert "5000000 runs: more than max_runs = 1000000; they would take " in told
        assert told.rstrip().endswith((" h", " days"))

    def test_the_results_of_another(self, refusal, cli, file):
        assert cli("experiment", file(SMALL), "--jobs", 1, "--no-report", "-o", "x").status == 0
        told = refusal("experiment", file(SMALL.replace("0.2", "0.1")), "-o", "x")
        assert "x: holds the results of another experiment: scenario.duration was 0.2, is" in told


class TestProcess:
    """What only real processes can show."""

    OPTIONS = ("experiment", "e.toml", "--no-report", "--jobs", 2)

    @pytest.fixture
    def riding(self, process, file, tmp_path: Path):
        """One in the middle of its batches."""
        file(MANY)
        begun = process(*self.OPTIONS)
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("runs/e/parts/*.parquet")):
            assert begun.poll() is None, begun.communicate()
            assert time.monotonic() < deadline
            time.sleep(0.01)
        yield begun
        if begun.poll() is None:
            begun.kill()
        begun.communicate()

    def test_a_signal_ends_it_and_what_was_computed_stays(self, riding, tmp_path: Path):
        riding.send_signal(signal.SIGINT)
        out, err = riding.communicate(timeout=60)
        assert riding.returncode in (130, -signal.SIGINT)
        done = rows(tmp_path / "runs/e")
        assert 0 < len(done) < 40
        last = err.splitlines()[-1]
        assert last == (
            f"bikesim: interrupted; {len(done)} of 40 runs are kept in runs/e, "
            "the same command goes on"
        )
        assert "law=paper" in out

    @pytest.mark.slow
    @pytest.mark.parametrize("crew", ["--jobs", "--workers"])
    def test_a_ctrl_c_is_for_all_of_its_processes_and_one_line(
        self, process, file, tmp_path: Path, crew
    ):
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
            f"bikesim: interrupted; {len(done)} of 40 runs are kept in runs/e, "
            "the same command goes on"
        )

    def test_killed_its_workers_end_and_it_goes_on(self, riding, process, cli, tmp_path: Path):
        workers = children(riding.pid)
        assert len(workers) == 2
        riding.kill()
        riding.wait(60)
        deadline = time.monotonic() + 30
        while any(alive(pid) for pid in workers):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        again = process(*self.OPTIONS)
        _, err = again.communicate(timeout=60)
        assert again.returncode == 0
        assert " of 40 runs in " in err
        undisturbed = ("--no-report", "--batch-size", 512, "-o", "undisturbed")
        assert cli("experiment", "e.toml", *undisturbed).status == 0
        assert rows(tmp_path / "runs/e") == rows(tmp_path / "undisturbed")

    def test_a_full_disk_is_one_line(self, riding, tmp_path: Path):
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
    def test_a_worker_that_dies_costs_nothing(self, process, file, tmp_path: Path, crew):
        file(KILLER, "killer.py")
        file("seeds = 2\nscenario = { duration = 0.1, rider.name = 'killer.py:Killer' }")
        begun = process("experiment", "e.toml", "--no-report", crew, 1, "--json")
        out, err = begun.communicate(timeout=60)
        assert (begun.returncode, err) == (0, "")
        assert json.loads(out)["runs"] == 2
        assert len(list((tmp_path / "marks").iterdir())) == 1

    def test_a_batch_that_kills_each_worker_is_one_line(self, process, file, tmp_path: Path):
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


RIDERS = """
import numpy as np

class Honest:
    def __init__(self, setting): ...
    def intend(self, steer, steer_rate, seen):
        return 3.0 * seen.roll + 5.0 * seen.roll_rate

class Average(Honest):
    def intend(self, steer, steer_rate, seen):
        return 0.0 * steer + np.mean(super().intend(steer, steer_rate, seen))
"""
WITH_RIDER = """
seeds = 2
keep = "first"
[scenario]
duration = 0.2
rider = "riders.py:{}"
"""


def test_a_rider_who_rides_otherwise_in_a_batch_is_one_line(refusal, file, tmp_path: Path):
    file(RIDERS, "riders.py")
    told = refusal("experiment", file(WITH_RIDER.format("Average")), "--jobs", 1, "--json")
    assert "riders.py:Average does not ride in a batch as he does alone: after 0.0" in told
    assert not (tmp_path / "runs/e/results.csv").exists()


def test_what_is_done_is_reported_without_the_riders_file(cli, file, tmp_path: Path):
    riders = tmp_path / file(RIDERS, "riders.py")
    file(WITH_RIDER.format("Honest"))
    first = cli("experiment", "e.toml", "--jobs", 1)
    assert first.status == 0
    riders.unlink()
    report = tmp_path / "runs/e/report.html"
    report.unlink()
    again = cli("experiment", "e.toml", "--jobs", 1)
    assert (again.status, again.err, again.out) == (0, "", first.out)
    assert report.exists()
    assert cli("experiment", "e.toml", "--json", "--no-report").json["runs"] == 2


def test_while_runs_are_missing_the_riders_file_is_too(cli, refusal, file, tmp_path: Path):
    riders = tmp_path / file(RIDERS, "riders.py")
    file(WITH_RIDER.format("Honest"))
    assert cli("experiment", "e.toml", "--jobs", 1, "--no-report").status == 0
    riders.unlink()
    (tmp_path / "runs/e/results.parquet").unlink()
    assert f"there is no file {riders}" in refusal("experiment", "e.toml", "--json")


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
