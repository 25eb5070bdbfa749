"""Files that a scenario's keys name: bicycle, rig, rider, path, torque."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bikesim import textfile

_LONGEST = 1000  # characters of a name


def beside(value: Any, folder: Path) -> Any:
    """What keys are set to, with each file that lies in `folder` named by its path from here.

    FILE, FILE.py:CLASS, FRAME+RIDER; a name that has no file there stays as it is.
    """
    if isinstance(value, Mapping):
        return {key: beside(one, folder) for key, one in value.items()}
    if isinstance(value, list):
        return [beside(one, folder) for one in value] if _has_text(value) else value
    if not _may_be_a_file(value):
        return value
    if textfile.is_there(folder / value):
        return str(folder / value)
    return "+".join(_path(one, folder) for one in value.split("+"))


def _has_text(values: list[Any]) -> bool:
    # A path may have thousands of points.
    return any(isinstance(one, str | list | Mapping) for one in values)


def _may_be_a_file(value: Any) -> bool:
    return isinstance(value, str) and "." in value and value.isprintable() and len(value) < _LONGEST


def _path(name: str, folder: Path) -> str:
    file, colon, kind = name.partition(":")
    if file and textfile.is_there(folder / file):
        return f"{folder / file}{colon}{kind}"
    return name
