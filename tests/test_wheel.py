"""The wheel, built from the source distribution, installed alone and used from an empty folder."""

import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def run(*command: str | Path, cwd: Path) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    ran = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert ran.returncode == 0, f"{command}\n{ran.stdout}\n{ran.stderr}"
    return ran.stdout


def build(source: Path, kind: str, into: Path, pattern: str) -> Path:
    run(sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", into, cwd=source)
    (built,) = into.glob(pattern)
    return built


@pytest.fixture(scope="module")
def wheel(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("built")
    archive = build(repository, "sdist", folder, "*.tar.gz")
    run(sys.executable, "-m", "tarfile", "-e", archive, folder, cwd=folder)
    (source,) = (path for path in folder.iterdir() if path.is_dir())
    return build(source, "wheel", folder, "*.whl")


@pytest.fixture(scope="module")
def scripts(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scripts of a fresh environment with the wheel in it.

    It sees the dependencies of this one, but not the source tree: entries of a path file that
    lie in a folder named by another path file are not followed.
    """
    folder = tmp_path_factory.mktemp("fresh") / "venv"
    run(sys.executable, "-m", "venv", "--without-pip", folder, cwd=folder.parent)
    python = folder / "bin" / "python"
    purelib = "import sysconfig; print(sysconfig.get_path('purelib'))"
    packages = Path(run(python, "-c", purelib, cwd=folder).strip())
    ours = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    (packages / "dependencies.pth").write_text("\n".join(sorted(ours)) + "\n")
    install = ("pip", "install", "--offline", "--no-cache", "--no-config", "--no-deps", "--python")
    run(sys.executable, "-m", "uv", *install, python, wheel, cwd=folder)
    return folder / "bin"


@pytest.fixture
def bikesim(scripts: Path, tmp_path: Path) -> Callable[..., str]:
    """Runs the installed command in an empty folder."""
    return lambda *arguments: run(scripts / "bikesim", *arguments, cwd=tmp_path)


def test_is_the_installed_package_that_runs(scripts: Path, tmp_path: Path):
    where = run(scripts / "python", "-c", "import bikesim; print(bikesim.__file__)", cwd=tmp_path)
    assert Path(where.strip()).is_relative_to(scripts.parent)


@pytest.mark.parametrize("folder", ["mjcf", "hardware"])
def test_carries_every_data_file(folder: str, scripts: Path, repository: Path, tmp_path: Path):
    code = f"from bikesim.data import data_path; print(data_path({folder!r}))"
    shipped = Path(run(scripts / "python", "-c", code, cwd=tmp_path).strip())
    assert shipped.is_relative_to(scripts.parent)
    assert files_under(shipped) == files_under(repository / folder)


def files_under(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}


def test_help(bikesim: Callable[..., str]):
    assert "usage: bikesim" in bikesim("--help")


def test_eigenvalues(bikesim: Callable[..., str]):
    shown = json.loads(bikesim("eig", "--bicycle", "benchmark", "--speeds", "5", "--json"))
    # Meijaard et al. 2007, Table 2, at 5 m/s: the capsize eigenvalue.
    assert min(abs(re + 0.32286642900409) for re, _ in shown["rows"][0]["bicycle"]) < 1e-9


def test_run_leaves_a_record(bikesim: Callable[..., str], tmp_path: Path):
    bikesim("run", "--duration", "1", "--output", "x.h5")
    assert (tmp_path / "x.h5").stat().st_size > 0
    assert list(tmp_path.iterdir()) == [tmp_path / "x.h5"]
