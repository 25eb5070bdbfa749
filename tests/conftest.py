"""Fixtures for all tests."""

from pathlib import Path

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Where tests go on several processes, those of a file stay together, with what they share.

    Those that ride in real time go one after the other. They may meet a moment in which a busy
    machine gives them no time: they have three tries, and one that fails has failed three times. No
    other test has more than one. What takes longest begins first.
    """
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    for item in items:
        group = item.nodeid.split("::")[0]
        if _in_real_time(item):
            group = "real time"
            item.add_marker(pytest.mark.flaky(reruns=2))
        item.add_marker(pytest.mark.xdist_group(group))
    items.sort(key=lambda item: (not _in_real_time(item), item.path not in slow))


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
