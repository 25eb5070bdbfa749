"""The files that scenarios are made of, with their digests."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from bikesim.experiment.scenario import Scenario
from bikesim.rider.kinds import is_custom
from bikesim.rider.source_files import package_version, source_files

Files = dict[str, str]
"""SHA-256 of each file by its name; and `version of PACKAGE`, of one that a rider comes from."""


def files_of_each(scenarios: Iterable[Scenario]) -> tuple[Files, ...]:
    """Of each scenario the files that it names, and those that a rider of the user's own is of.

    Each is read once, however many scenarios name it.
    """
    digest, of_rider = cache(_digest), cache(_of_rider)
    found: list[Files] = []
    for scenario in scenarios:
        names = set(_names(scenario.model_dump(mode="json", exclude={"seed"})))
        digests = {name: digest(name) for name in sorted(names)}
        files = {name: value for name, value in digests.items() if value}
        found.append(files | of_rider(scenario.rider.name))
    return tuple(found)


def union(files: Iterable[Files]) -> Files:
    """All of them, by name."""
    return {name: digest for one in files for name, digest in one.items()}


def _names(keys: Any) -> Iterator[str]:
    """What may be the name of a file, anywhere in a scenario."""
    if isinstance(keys, Mapping):
        keys = list(keys.values())
    if isinstance(keys, list):
        for value in keys:
            yield from _names(value)
    elif isinstance(keys, str):
        # "frame.txt+rider.txt" is two files, "rider.py:Class" is one.
        for name in {keys, *keys.split("+"), keys.rpartition(":")[0]}:
            if "." in name and len(name) < 1000:
                yield str(Path(name))


def _of_rider(name: str) -> Files:
    """The files of a rider of the user's own with their digests, and his package's version."""
    if not is_custom(name):
        return {}
    found = {told: _digest(path) for told, path in source_files(name).items()}
    if not name.rpartition(":")[0].endswith(".py") and (is_ := package_version(name)):
        found[f"version of {name.partition('.')[0].partition(':')[0]}"] = is_
    return found


def _digest(path: str | Path) -> str:
    """Empty where there is no such file."""
    path = Path(path)
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
