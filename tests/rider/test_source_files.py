"""The files of a rider of one's own, found in what they import."""

import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from bikesim.rider.source_files import package_version, source_files


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    files = {
        "mine.py": "import numpy, gains\nfrom tools import lag\n"
        "def late():\n    import later\n"
        "class Mine:\n    def intend(self, *a): ...\n",
        "gains.py": "from values import GAIN\nimport mine\n",
        "values.py": "GAIN = 1\n",
        "later.py": "(\n",
        "other.py": "",
        "tools/__init__.py": "",
        "tools/lag.py": "from . import filters\nfrom .deep.more import x\n",
        "tools/filters.py": "",
        "tools/unused.py": "",
        "tools/deep/__init__.py": "",
        "tools/deep/more.py": "from .. import parent\nx = 1\n",
        "tools/parent.py": "",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    return tmp_path


def test_what_lies_beside_is_followed_and_nothing_else(folder: Path):
    del folder
    assert sorted(source_files("mine.py:Mine")) == [
        "gains.py", "later.py", "mine.py",
        "tools/__init__.py", "tools/deep/__init__.py", "tools/deep/more.py", "tools/filters.py",
        "tools/lag.py", "tools/parent.py", "values.py",
    ]  # fmt: skip


def test_of_a_package_only_its_own(folder: Path):
    (folder / "tools" / "lag.py").write_text("import values\nfrom tools.filters import x\n")
    assert source_files("tools.lag:Lag") == {
        name: folder / name for name in ("tools/__init__.py", "tools/lag.py", "tools/filters.py")
    }


def test_who_is_not_there_has_none():
    assert source_files("gone.py:Mine") == {}
    assert source_files("not_there_at_all.rider:Mine") == {}


def test_an_installed_package_has_a_version(folder: Path):
    del folder
    assert package_version("yaml.loader:Loader") == f"PyYAML {version('PyYAML')}"
    assert package_version("tools.lag:Lag") is None
