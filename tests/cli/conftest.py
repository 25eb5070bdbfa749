"""The command line in this process, and as one of its own where a process is the point."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from bikesim.cli.main import main


class Said(NamedTuple):
    """What a command left: its exit status and what it printed."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        assert (self.status, self.err) == (0, ""), self.err
        return json.loads(self.out)


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch) -> Callable[..., Said]:
    """`cli("run", "--speed", 4)` in an empty folder, in this process."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: object) -> Said:
        capsys.readouterr()
        status = main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        return Said(status, printed.out, printed.err)

    return call


@pytest.fixture
def refusal(cli) -> Callable[..., str]:
    """The one line with which a command is refused, by status 2 and without other output."""

    def call(*arguments: object) -> str:
        said = cli(*arguments)
        assert (said.status, said.out) == (2, "")
        assert said.err.startswith("bikesim: ")
        assert said.err.count("\n") == 1
        return said.err

    return call


@pytest.fixture
def process(tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """`process("run")` begins the same in a process of its own."""

    def begin(*arguments: object, **options: Any) -> subprocess.Popen[str]:
        pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        return subprocess.Popen(
            [sys.executable, "-m", "bikesim", *map(str, arguments)],
            cwd=tmp_path,
            text=True,
            **(pipes | options),
        )

    return begin


@pytest.fixture(scope="session")
def ridden(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of one second, pushed once; not to be written to."""
    path = tmp_path_factory.mktemp("ridden") / "ridden.h5"
    arguments = ["run", "--duration", "1", "--push", "0.2:5", "--output", str(path)]
    assert main(arguments) == 0
    return path


@pytest.fixture
def record(ridden: Path, tmp_path: Path) -> Path:
    """The same record under `run.h5` in the test's own folder."""
    copy = tmp_path / "run.h5"
    copy.write_bytes(ridden.read_bytes())
    return copy


@pytest.fixture
def file(tmp_path: Path):
    """Writes a file into the test's folder; gives its name there."""

    def write(text: str, name: str = "e.toml") -> str:
        (tmp_path / name).write_text(text)
        return name

    return write
