"""The files that ship with the package, in the source tree."""

from pathlib import Path

import pytest

from bikesim.data import data_path
from bikesim.errors import InputError


def test_finds_a_file_of_the_source_tree(repository: Path):
    assert data_path("mjcf", "rig.xml") == repository / "mjcf" / "rig.xml"


def test_a_missing_file_names_the_near_one():
    with pytest.raises(InputError, match=r"'rug\.xml'.*rig\.xml"):
        data_path("mjcf", "rug.xml")


def test_a_missing_folder_is_said():
    with pytest.raises(InputError, match="missing"):
        data_path("no such folder", "rig.xml")
