"""Fixtures for all tests."""

from functools import cache
from pathlib import Path
from typing import Any

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that ride in real time may meet a moment in which a busy machine gives them no time:
    they have three tries, and one that fails has failed three times. No other test has more than
    one. They begin first, then the files in which something takes long.
    """
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    for item in items:
        if _in_real_time(item):
            item.add_marker(pytest.mark.flaky(reruns=2))
    items.sort(key=lambda item: (not _in_real_time(item), item.path not in slow))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Where tests go on several processes, those of a file stay together, with what they share;
    files with tests that ride in real time go one after the other.
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        # Not by xdist's groups: 3.8 writes them where pytest 9.2 does not look any more.
        def _split_scope(self, nodeid: str) -> str:
            return _group(config.rootpath / nodeid.split("::", maxsplit=1)[0])

    return ByFile(config, log)


@cache
def _group(file: Path) -> str:
    return "real time" if "pytest.mark.real_time" in file.read_text() else str(file)


def _in_real_time(item: pytest.Item) -> bool:
    return item.get_closest_marker("real_time") is not None


@pytest.fixture(scope="session")
def repository() -> Path:
    """The source tree."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def shared(repository: Path) -> Path:
    """The folder of measured data beside the repository, which is not part of it."""
    path = repository.parent / "shared"
    if not path.is_dir():
        pytest.fail("the folder ../shared with the measured data is missing beside the repository")
    return path
