"""The software that a run's figures depend on."""

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple, Self

import bikesim
from bikesim.data import data_path

# What only shows, asks or drives a bench; a run's figures are made without them.
_BESIDE = {"bench", "cli", "identify", "report", "view"}
_SOURCES = {".py", ".toml"}


class Versions(NamedTuple):
    """Of what computes a run; `code` is a digest of the source of bikesim itself.

    A version stays the same while somebody works on the source, and so does the commit of a tree
    that has been changed since; their digest does not.
    """

    bikesim: str
    mujoco: str
    numpy: str
    code: str

    @classmethod
    def gather(cls) -> Self:
        """Those installed, as this process began with them."""
        return cls(bikesim.__version__, version("mujoco"), version("numpy"), _code())

    def __str__(self) -> str:
        return ", ".join(f"{name} {value}" for name, value in self._asdict().items())


@cache
def _code() -> str:
    package = Path(bikesim.__file__).parent
    files = {path.relative_to(package).as_posix(): path for path in package.rglob("*.*")}
    sources = {name: path for name, path in files.items() if _decisive(name, path)}
    # Of the wheel's data only this: a bicycle's or a rig's figures stand in a scenario.
    sources["rig.xml"] = data_path("mjcf", "rig.xml")
    digest = hashlib.sha256()
    for name, path in sorted(sources.items()):
        digest.update(f"{name}\0{path.stat().st_size}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def _decisive(name: str, path: Path) -> bool:
    rooms = _BESIDE | {"_data", "shipped"}
    return path.suffix in _SOURCES and rooms.isdisjoint(name.split("/")) and path.is_file()
