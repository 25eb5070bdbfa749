"""A child process finds the modules that this one finds, and no others."""

import subprocess
from pathlib import Path

import pytest

import bikesim
from bikesim.child import child_command

FILES = sorted(Path(bikesim.__file__).parent.rglob("*.py"))


def said(folder: Path, module: str, *arguments: str) -> str:
    command = child_command(module, *arguments)
    ran = subprocess.run(command, cwd=folder, capture_output=True, check=False, timeout=60)
    assert ran.returncode == 0, ran.stderr.decode()
    return ran.stdout.decode().strip()


@pytest.mark.parametrize("name", ["bikesim", "json", "signal"])
def test_a_module_in_the_current_folder_is_not_taken_for_another(tmp_path: Path, name: str):
    (tmp_path / f"{name}.py").write_text("raise SystemExit('of the current folder')\n")
    assert said(tmp_path, "bikesim", "--version") == f"bikesim {bikesim.__version__}"


def test_it_finds_what_this_process_was_told_to_find(tmp_path: Path, monkeypatch):
    mine, elsewhere = tmp_path / "mine", tmp_path / "elsewhere"
    mine.mkdir()
    elsewhere.mkdir()
    (mine / "told.py").write_text("import sys; print(__name__, *sys.argv[1:])\n")
    monkeypatch.syspath_prepend(mine)
    assert said(elsewhere, "told", "a", "b c") == "__main__ a b c"


def test_none_is_begun_in_another_way():
    assert [file for file in FILES if '"-m"' in file.read_text(encoding="utf-8")] == []
