"""A folder of results is there whole or not at all."""

from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.report.paper.folder import whole_folder


def fill(path: Path, *, force: bool, text: str = "new") -> None:
    with whole_folder(path, force=force) as folder:
        (folder / "records").mkdir()
        (folder / "records" / "a.txt").write_text(text)


def test_files_are_moved_into_place(tmp_path: Path):
    fill(tmp_path / "deep" / "paper", force=False)
    assert (tmp_path / "deep" / "paper" / "records" / "a.txt").read_text() == "new"
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["paper"]


def test_a_folder_that_is_there_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match="already there; --force"):
        fill(tmp_path, force=False)


def test_a_file_is_refused(tmp_path: Path):
    (tmp_path / "paper").write_text("mine")
    with pytest.raises(InputError, match="is not a folder"):
        fill(tmp_path / "paper", force=True)


def test_force_replaces_files_and_leaves_others(tmp_path: Path):
    (tmp_path / "mine.txt").write_text("mine")
    fill(tmp_path, force=True, text="old")
    fill(tmp_path, force=True)
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert (tmp_path / "records" / "a.txt").read_text() == "new"
    assert not (tmp_path / ".part").exists()


def test_nothing_is_left_after_an_interruption(tmp_path: Path):
    def interrupted() -> None:
        with whole_folder(tmp_path / "paper", force=False) as folder:
            (folder / "a.txt").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_said_in_one_line(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        fill(tmp_path / "file" / "paper", force=False)
