"""requirements.lock: pinned, hashed, without addresses, and what pyproject.toml asks for."""

import re
import tomllib
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PIN = re.compile(r"^(?P<name>[\w.-]+)==(?P<version>\S+)(?: ; [^\\]+?)? \\$", re.MULTILINE)
ENTRY = re.compile(r"^[^\s#].*(?:\n    --hash=sha256:[0-9a-f]{64}(?: \\)?)+$", re.MULTILINE)


@pytest.fixture(scope="module")
def lock(repository: Path) -> str:
    return (repository / "requirements.lock").read_text()


def asked_for(repository: Path) -> list[Requirement]:
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    lists = [project["dependencies"], *project["optional-dependencies"].values()]
    return [Requirement(line) for line in chain(*lists)]


def test_has_no_address_and_no_path(lock: str):
    assert "://" not in lock
    assert "/" not in lock
    assert "--index" not in lock
    assert "--find-links" not in lock


def test_each_entry_is_pinned_and_hashed(lock: str):
    entries = re.findall(r"^[^\s#].*$", lock, re.MULTILINE)
    assert len(entries) > 20
    assert len(PIN.findall(lock)) == len(ENTRY.findall(lock)) == len(entries)


def test_pins_what_the_project_asks_for(lock: str, repository: Path):
    pins: dict[str, set[str]] = {}
    for pin in PIN.finditer(lock):
        pins.setdefault(canonicalize_name(pin["name"]), set()).add(pin["version"])
    for requirement in asked_for(repository):
        versions = pins.get(canonicalize_name(requirement.name), set())
        assert versions, f"{requirement.name} is not locked: make lock"
        assert all(requirement.specifier.contains(v) for v in versions), requirement


def test_pins_nothing_that_the_project_no_longer_asks_for(lock: str, repository: Path):
    asked = {canonicalize_name(requirement.name) for requirement in asked_for(repository)}
    blocks = re.split(r"\n(?=[^\s#])", lock)
    direct = {b.split("==")[0] for b in blocks if "bikesim (pyproject.toml)" in b}
    assert direct == asked
