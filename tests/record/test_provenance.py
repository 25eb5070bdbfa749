import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import bikesim
from bikesim.record.provenance import Provenance, source_commit


def git(root: Path, *arguments: str) -> str:
    identity = ("-c", "user.name=a", "-c", "user.email=a@example.org")
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    command = ["git", *identity, *arguments]
    return subprocess.run(
        command, cwd=root, env=environment, check=True, capture_output=True, text=True
    ).stdout.strip()


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    git(tmp_path, "init", "-q")
    (tmp_path / "a.py").write_text("a = 1\n")
    git(tmp_path, "add", "a.py")
    git(tmp_path, "commit", "-q", "-m", "first")
    return tmp_path


def test_versions_are_those_installed():
    provenance = Provenance.gather()
    assert provenance.bikesim == bikesim.__version__
    assert provenance.h5py == version("h5py")
    assert provenance.mujoco == version("mujoco")


def test_gathering_imports_nothing_heavy():
    code = (
        "import sys; from bikesim.record.provenance import Provenance; Provenance.gather();"
        "print({'numpy', 'scipy', 'mujoco', 'h5py', 'pydantic'} & set(sys.modules))"
    )
    root = Path(bikesim.__file__).parents[1]
    environment = {**os.environ, "PYTHONPATH": str(root)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "set()"


def test_a_platform_that_cannot_be_found_out_is_unknown(monkeypatch: pytest.MonkeyPatch):
    def fails() -> str:
        raise OSError

    monkeypatch.setattr("platform.platform", fails)
    assert Provenance.gather().platform == "unknown"


def test_the_commit_of_a_clean_tree(tree: Path):
    assert source_commit(tree) == git(tree, "rev-parse", "HEAD")


def test_a_changed_tree_is_dirty(tree: Path):
    (tree / "a.py").write_text("a = 2\n")
    assert source_commit(tree) == git(tree, "rev-parse", "HEAD") + "+dirty"


def test_a_tree_without_a_commit_has_none(tmp_path: Path):
    git(tmp_path, "init", "-q")
    assert source_commit(tmp_path) is None


def test_a_folder_inside_somebody_elses_tree_has_none(tree: Path):
    (tree / "site-packages").mkdir()
    assert source_commit(tree / "site-packages") is None


def test_a_variable_of_a_git_hook_does_not_lead_elsewhere(
    tree: Path, monkeypatch: pytest.MonkeyPatch
):
    commit = git(tree, "rev-parse", "HEAD")
    monkeypatch.setenv("GIT_DIR", str(tree / "elsewhere"))
    assert source_commit(tree) == commit
