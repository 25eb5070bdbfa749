"""The folder of results: what it takes, what it refuses, what it never loses."""

import json
import resource
import signal
from pathlib import Path

import pandas as pd
import pytest

from bikesim.errors import InputError
from bikesim.experiment.metrics import Metrics
from bikesim.experiment.study import manifest, named_files
from bikesim.experiment.study.folder import open_folder
from bikesim.experiment.study.plan import RunId, Study
from bikesim.experiment.study.results import read_results
from bikesim.experiment.study.versions import Versions
from bikesim.experiment.study.work import Done, Result

from .conftest import SMALL


def done(*runs: tuple[int, int]) -> Done:
    """Runs of which each figure is the seed."""
    return Done(
        tuple(Result(RunId(*run), "end of run", 200) for run in runs),
        tuple(Metrics(*[float(run[1])] * len(Metrics._fields)) for run in runs),
        "2026-01-01T00:00:00+00:00",
        1.0,
        Versions.gather(),
    )


def begin(study: Study, path: Path, *runs: tuple[int, int]) -> None:
    with open_folder(path, study, force=False) as folder:
        folder.add(1, done(*runs), "test-1")


def refusal(study: Study, path: Path) -> str:
    with pytest.raises(InputError) as raised, open_folder(path, study, force=False):
        pass
    assert "\n" not in str(raised.value)
    return str(raised.value)


class TestParts:
    def test_are_found_again_and_merged_in_order(self, small, tmp_path: Path):
        begin(small, tmp_path, (4, 2), (1, 3))
        with open_folder(tmp_path, small, force=False) as folder:
            assert folder.done == {RunId(4, 2), RunId(1, 3)}
            folder.add(2, done((1, 1)), "test-2")
            folder.merge()
        results = read_results(tmp_path)
        assert results.table["run"].tolist() == ["1-1", "1-3", "4-2"]
        assert results.table["roll_rms"].tolist() == [1, 3, 2]
        assert results.table["worker"].tolist() == ["test-2", "test-1", "test-1"]
        assert results.planned == 12
        assert not (tmp_path / "parts").exists()

    def test_csv_and_parquet_say_the_same(self, small, tmp_path: Path):
        begin(small, tmp_path, (4, 2), (1, 3))
        with open_folder(tmp_path, small, force=False) as folder:
            folder.merge()
        read = pd.read_csv(tmp_path / "results.csv")
        expected = read_results(tmp_path).table
        pd.testing.assert_frame_equal(read, expected, check_exact=True, check_dtype=False)

    def test_a_run_that_a_kill_left_twice_is_there_once(self, small, tmp_path: Path):
        begin(small, tmp_path, (1, 1), (1, 2))
        part = next((tmp_path / "parts").iterdir()).read_bytes()
        with open_folder(tmp_path, small, force=False) as folder:
            folder.merge()
            (tmp_path / "parts").mkdir()
            (tmp_path / "parts" / "000001.parquet").write_bytes(part)
            folder.merge()
        assert read_results(tmp_path).table["run"].tolist() == ["1-1", "1-2"]

    def test_a_damaged_one_is_told(self, small, tmp_path: Path):
        begin(small, tmp_path, (1, 1))
        part = tmp_path / "parts" / "000001.parquet"
        part.write_bytes(part.read_bytes()[:100])
        message = refusal(small, tmp_path)
        assert message.startswith(f"{part}: cannot be read: ")
        assert message.endswith("; remove it to ride its runs again")


class TestOthers:
    def test_a_folder_with_something_else_is_refused(self, small, tmp_path: Path):
        (tmp_path / "thesis.tex").touch()
        assert refusal(small, tmp_path) == (
            f"{tmp_path}: holds no experiment's results, but thesis.tex; give another with -o"
        )
        assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]

    def test_a_file_is_refused(self, small, tmp_path: Path):
        (tmp_path / "file").touch()
        assert "is not a folder" in refusal(small, tmp_path / "file")

    @pytest.mark.parametrize(
        ("before", "after", "told"),
        [
            ("seeds = 3", "seeds = 4", "seeds was 3, is 4"),
            ("seeds = 3", "seeds = [1, 2, 9]", "seeds was 3, is [1, 2, 9]"),
            ("0.2]", "0.3]", "factors.rider.visual_delay was [0.1, 0.2], is [0.1, 0.3]"),
            ("duration = 0.2", "duration = 0.3", "scenario.duration was 0.2, is 0.3"),
            ('"off"]', '"off"]\nspeed = [3]', "factors.speed was not given, is [3]"),
        ],
    )
    def test_a_changed_experiment_is_refused(self, make, tmp_path, before, after, told):
        assert before in SMALL
        begin(make(SMALL), tmp_path / "results", (1, 1))
        message = refusal(make(SMALL.replace(before, after)), tmp_path / "results")
        assert f"holds the results of another experiment: {told}; " in message
        assert message.endswith("give another folder with -o, or --force to begin anew")

    def test_what_changes_no_result_may_change(self, make, tmp_path: Path):
        begin(make(SMALL), tmp_path, (1, 1))
        other = 'keep = "all"\nbatch_size = 3\n' + SMALL.replace("Small", "Large")
        with open_folder(tmp_path, make(other), force=False) as folder:
            assert folder.done == {RunId(1, 1)}
        assert read_title(tmp_path) == "Large"

    def test_a_file_that_it_names_may_not_change(self, make, tmp_path: Path):
        from bikesim import bicycles

        bicycle = tmp_path / "mine.toml"
        bicycle.write_text(bicycles.to_toml(bicycles.load("benchmark")))
        text = "seeds = 1\nscenario.bicycle = 'mine.toml'"
        begin(make(text), tmp_path / "results", (1, 1))
        bicycle.write_text(bicycle.read_text() + "\n# and a remark")
        told = f"another experiment: {bicycle} has changed; "
        assert told in refusal(make(text), tmp_path / "results")

    def test_other_versions_are_refused_while_runs_are_missing(self, small, tmp_path, monkeypatch):
        begin(small, tmp_path, (1, 1))
        begun, other = Versions(*_versions(tmp_path)), Versions("0.0.1", "4.0.0", "2.0", "abc")
        monkeypatch.setattr(manifest.Versions, "gather", lambda: other)
        monkeypatch.setattr(manifest, "source_commit", lambda root: None)
        message = refusal(small, tmp_path)
        assert f"was begun with {begun}" in message
        assert f", this is {other}; give another folder with -o" in message

    def test_so_is_other_code_of_one_version_which_is_told_with_its_commit(
        self, small, tmp_path, monkeypatch
    ):
        monkeypatch.setattr(manifest, "source_commit", lambda root: f"{'1' * 40}+dirty")
        begin(small, tmp_path, (1, 1))
        begun = Versions.gather()
        other = begun._replace(code="0123456789ab")
        monkeypatch.setattr(manifest.Versions, "gather", lambda: other)
        message = refusal(small, tmp_path)
        commit = "commit 111111111111+dirty"
        assert f"was begun with {begun}, {commit}, this is {other}, {commit}; " in message

    def test_of_what_is_done_the_software_may_be_another(self, small, tmp_path, monkeypatch):
        begin(small, tmp_path, *((c, seed) for c in (1, 2, 3, 4) for seed in (1, 2, 3)))
        other = Versions.gather()._replace(code="0123456789ab")
        monkeypatch.setattr(manifest.Versions, "gather", lambda: other)
        with open_folder(tmp_path, small, force=False) as folder:
            assert len(folder.done) == small.runs

    def test_what_a_riders_file_imports_may_not_change(self, make, tmp_path: Path):
        (tmp_path / "mine.py").write_text("from gains import GAIN\nclass Mine: ...\n")
        (tmp_path / "gains.py").write_text("GAIN = 1.0\n")
        text = "seeds = 1\nscenario.rider = 'mine.py:Mine'"
        begin(make(text), tmp_path / "results", (1, 1))
        (tmp_path / "gains.py").write_text("GAIN = 2.0\n")
        told = f"another experiment: {tmp_path / 'gains.py'} has changed; "
        assert told in refusal(make(text), tmp_path / "results")

    def test_nor_may_the_package_that_a_rider_comes_from(self, make, tmp_path, monkeypatch):
        text = "seeds = 1\nscenario.rider = 'yaml.loader:Loader'"
        begin(make(text), tmp_path / "results", (1, 1))
        monkeypatch.setattr(named_files, "package_version", lambda name: "PyYAML 0.1")
        told = "another experiment: version of yaml has changed; "
        assert told in refusal(make(text), tmp_path / "results")
        files = json.loads((tmp_path / "results" / "manifest.json").read_text())["files"]
        assert {"yaml/loader.py", "yaml/reader.py"} <= set(files)

    def test_force_begins_anew_and_removes_nothing_else(self, make, small, tmp_path: Path):
        begin(small, tmp_path, (1, 1))
        (tmp_path / "notes.txt").touch()
        other = make(SMALL.replace("seeds = 3", "seeds = 4"))
        with open_folder(tmp_path, other, force=True) as folder:
            assert folder.done == set()
        assert (tmp_path / "notes.txt").exists()
        assert not (tmp_path / "parts").exists()

    def test_it_is_not_for_two_at_once(self, small, tmp_path: Path):
        import subprocess
        import sys

        code = (
            "import fcntl, os, sys, time\n"
            "file = os.open(sys.argv[1], os.O_RDWR | os.O_CREAT)\n"
            "fcntl.lockf(file, fcntl.LOCK_EX); print('held', flush=True); time.sleep(60)"
        )
        begin(small, tmp_path, (1, 1))
        holder = subprocess.Popen(
            [sys.executable, "-c", code, str(tmp_path / ".lock")], stdout=subprocess.PIPE
        )
        try:
            assert holder.stdout is not None
            assert holder.stdout.readline() == b"held\n"
            assert refusal(small, tmp_path) == f"{tmp_path}: another bikesim is working on it"
        finally:
            holder.kill()
            holder.communicate()
        begin(small, tmp_path, (1, 2))


class TestReading:
    def test_a_folder_without_results_is_told(self, small, tmp_path: Path):
        with pytest.raises(InputError, match="is not a folder of an experiment's results"):
            read_results(tmp_path)
        with open_folder(tmp_path, small, force=False):
            pass
        with pytest.raises(InputError, match="has no results yet"):
            read_results(tmp_path)

    def test_a_damaged_manifest_is_told(self, small, tmp_path: Path):
        begin(small, tmp_path, (1, 1))
        (tmp_path / "manifest.json").write_text("{}")
        with pytest.raises(InputError, match=r"manifest\.json: is damaged"):
            read_results(tmp_path)

    def test_the_experiment_in_it_is_the_same_again(self, make, tmp_path: Path):
        (tmp_path / "ride.toml").write_text("speed = 4.0\n")
        study = make("base = 'ride.toml'\ntitle = 'A'\nseeds = [4, 2]\nfactors.law = ['off']")
        begin(study, tmp_path / "results", (1, 4))
        again = manifest.Manifest.of(study)
        with open_folder(tmp_path / "results", study, force=False) as folder:
            folder.merge()
        read = read_results(tmp_path / "results").study
        assert manifest.Manifest.of(read).digest == again.digest
        assert read.experiment.seeds == (4, 2)


def test_a_full_disk_is_told_and_keeps_what_was_there(small, tmp_path: Path):
    begin(small, tmp_path, (1, 1))
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        with open_folder(tmp_path, small, force=False) as folder:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
            with pytest.raises(InputError) as raised:
                folder.add(2, done((1, 2)), "test-1")
            assert folder.done == {RunId(1, 1)}
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    assert str(raised.value) == (
        f"{tmp_path / 'parts' / '000002.parquet'}: cannot be written: file too large; 1 of 12 runs "
        f"are kept in {tmp_path}, the same command goes on"
    )
    assert [path.name for path in (tmp_path / "parts").iterdir()] == ["000001.parquet"]
    with open_folder(tmp_path, small, force=False) as folder:
        assert folder.done == {RunId(1, 1)}


def read_title(path: Path) -> str:
    import tomllib

    return tomllib.loads((path / "experiment.toml").read_text())["title"]


def _versions(path: Path) -> list[str]:
    return list(json.loads((path / "manifest.json").read_text())["versions"].values())


def test_the_kept_file_has_the_factors_in_their_order(make):
    """A list written after a table would otherwise come before it, and with it its conditions."""
    study = make(
        """
        seeds = 1
        [factors.haptics.on]
        law = "paper"
        [factors.haptics.off]
        law = "off"
        [factors]
        speed = [3.5, 5.0]
        """
    )
    again = make(manifest.to_toml(study.experiment))
    assert [one.name for one in again.conditions] == [one.name for one in study.conditions]
    assert [one.name for one in again.factors] == ["haptics", "speed"]
