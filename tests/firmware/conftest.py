"""The node's firmware, compiled for this machine with the board that is not there."""

import shutil
import subprocess
from ctypes import CDLL
from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database

from .binding import Firmware
from .nodes import PowerUp, block


@pytest.fixture(scope="session")
def library(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built by its own Makefile, in which warnings are errors."""
    assert shutil.which("cc"), "the tests of the firmware need a C compiler (cc)"
    assert shutil.which("make"), "the tests of the firmware need make"
    folder = tmp_path_factory.mktemp("firmware")
    source = repository / "hardware" / "firmware"
    made = subprocess.run(
        ["make", "-C", source, f"BUILD={folder}"], capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stderr
    return folder / "libnode.so"


@pytest.fixture
def power_up(library: Path) -> PowerUp:
    """Starts a node with what its memory has; the memory of a new one is erased."""
    return lambda memory=b"\xff" * 32: Firmware(CDLL(str(library)), memory)


@pytest.fixture(scope="session")
def database(repository: Path) -> Database:
    """The project's, as cantools has it."""
    found = cantools.database.load_file(repository / "hardware" / "can" / "steer_node.dbc")
    assert isinstance(found, Database)
    return found


@pytest.fixture
def node(power_up: PowerUp) -> Firmware:
    """A calibrated one."""
    return power_up(block())
