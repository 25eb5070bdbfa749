"""Fixtures for all tests."""

from pathlib import Path

import pytest

_FIXTURES = frozenset(("wire", "process"))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that ride in real time go one after the other, where tests go on several processes.

    They, those on a bus of threads and those that begin processes may meet a moment in which a busy
    machine gives them no time: they have three tries. A test that fails has failed three times.
    """
    for item in items:
        rides = item.get_closest_marker("real_time") is not None
        if rides:
            item.add_marker(pytest.mark.xdist_group("real time"))
        begins = item.get_closest_marker("processes") is not None
        if rides or begins or not _FIXTURES.isdisjoint(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.flaky(reruns=2))


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
