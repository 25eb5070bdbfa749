"""bikesim experiment"""

from pathlib import Path

import pyarrow.parquet as pq
import pytest

from .experiments import MANY, rows

SMALL = """
title = "Haptics, very short"
seeds = 2
keep = "first"
[scenario]
duration = 0.2
[factors]
law = ["paper", "off"]
"""


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
