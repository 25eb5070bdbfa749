"""Fixtures for all tests."""

from pathlib import Path

import pytest


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
