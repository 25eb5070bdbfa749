"""Files that are no whole record, for every command that reads one."""

from pathlib import Path

import h5py
import pytest

COMMANDS = [("info",), ("replay",), ("plot",), ("export", "out.csv")]


@pytest.fixture(params=COMMANDS, ids=lambda command: command[0])
def read(request: pytest.FixtureRequest, refusal, tmp_path: Path):
    """The one line with which a command refuses a file as its record."""
    command, *output = request.param

    def call(name: str) -> str:
        message = refusal(command, name, *output)
        assert {path.name for path in tmp_path.iterdir()} <= {name}
        return message

    return call


def test_missing(read):
    assert read("nix.h5") == "bikesim: nix.h5: no such file\n"


def test_a_folder(read, tmp_path: Path):
    (tmp_path / "run.h5").mkdir()
    assert read("run.h5") == "bikesim: run.h5: is a folder, not a run file\n"


def test_empty(read, tmp_path: Path):
    (tmp_path / "run.h5").touch()
    assert read("run.h5") == "bikesim: run.h5: is empty, not a run file\n"


def test_text(read, tmp_path: Path):
    (tmp_path / "run.h5").write_text("time,roll\n0,1\n")
    assert read("run.h5") == "bikesim: run.h5: is not an HDF5 file, so not a run file\n"


def test_another_hdf5_file(read, tmp_path: Path):
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["roll"] = [1.0, 2.0]
    assert read("run.h5") == "bikesim: run.h5: is an HDF5 file, but not a run of bikesim\n"


@pytest.mark.parametrize("part", [0.1, 0.5, 0.99])
def test_truncated(read, record: Path, part: float):
    whole = record.read_bytes()
    record.write_bytes(whole[: int(part * len(whole))])
    assert "run.h5: truncated or damaged run file" in read("run.h5")


def test_of_a_newer_format(read, record: Path):
    with h5py.File(record, "r+") as file:
        file.attrs["format_version"] = 99
    assert "run.h5: written by a newer bikesim (format 99)" in read("run.h5")
