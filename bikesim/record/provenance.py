"""Which software made a record."""

import os
import platform
import subprocess
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Self

import bikesim


@dataclass(frozen=True)
class Provenance:
    """Versions, the commit of the source tree ("+dirty" if changed since), the time in UTC."""

    bikesim: str
    commit: str | None
    python: str
    platform: str
    mujoco: str | None
    numpy: str | None
    scipy: str | None
    h5py: str | None
    pydantic: str | None
    created: str

    @classmethod
    def gather(cls) -> Self:
        """That of this process, now; imports none of the packages."""
        return cls(
            bikesim=bikesim.__version__,
            commit=source_commit(Path(bikesim.__file__).parents[1]),
            python=platform.python_version(),
            platform=_platform(),
            mujoco=_installed("mujoco"),
            numpy=_installed("numpy"),
            scipy=_installed("scipy"),
            h5py=_installed("h5py"),
            pydantic=_installed("pydantic"),
            created=datetime.now(UTC).isoformat(timespec="milliseconds"),
        )


def _platform() -> str:
    try:
        return platform.platform()  # may read files and start programs
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def source_commit(root: Path) -> str | None:
    """The commit of the git work tree whose root is `root`; None if it is not one."""
    # Without this check an environment inside some other repository would give that one's commit.
    try:
        if not (root / ".git").exists():
            return None
    except OSError:
        return None
    lines = _git_status(root).splitlines()
    oid = next((line.split()[-1] for line in lines if line.startswith("# branch.oid ")), None)
    if oid is None or oid == "(initial)":
        return None
    changed = any(not line.startswith("#") for line in lines)
    return oid + "+dirty" if changed else oid


def _git_status(root: Path) -> str:
    # A variable such as GIT_DIR, set inside a git hook, would point git elsewhere.
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    try:
        return subprocess.run(
            ["git", "status", "--porcelain=v2", "--branch", "--untracked-files=no"],
            cwd=root,
            env={**environment, "GIT_OPTIONAL_LOCKS": "0"},
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=5,
            check=True,
        ).stdout
    except (OSError, subprocess.SubprocessError):
        return ""


def _installed(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
