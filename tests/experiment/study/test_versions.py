"""The software that a run's figures depend on, down to a line of its source."""

from collections.abc import Callable
from pathlib import Path

import pytest

import bikesim
from bikesim.experiment.study import versions


@pytest.fixture
def code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[dict[str, str]], str]:
    """The digest of a source tree with these files; given again, they are put beside the others."""
    monkeypatch.setattr(bikesim, "__file__", str(tmp_path / "__init__.py"))

    def digest(files: dict[str, str]) -> str:
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        return versions._code.__wrapped__()

    return digest


TREE = {"loop.py": "tick = 1\n", "model/law.py": "k = 2\n", "bicycles/data/mine.toml": "w = 1\n"}


@pytest.mark.parametrize("name", [*TREE, "model/new.py"])
def test_a_change_in_what_computes_is_another_code(code, name: str):
    before = code(TREE)
    assert code({name: "k = 3\n"}) != before
    assert len(before) == 12


def test_a_name_is_part_of_it(code, tmp_path: Path):
    before = code(TREE)
    (tmp_path / "loop.py").rename(tmp_path / "pool.py")
    assert code({}) != before


@pytest.mark.parametrize(
    "name",
    ["cli/run.py", "report/page.py", "bench/rig.py", "model/law.pyc", "py.typed"],
)
def test_what_only_shows_is_not(code, name: str):
    assert code(TREE) == code({name: "x = 1\n"})


def test_all_versions_are_known():
    assert all(versions.Versions.gather())
