import tomllib
from pathlib import Path

import pytest

from bikesim.bench.profile import load_bench
from bikesim.bench.profile_file import change_profile, changed_text, own_profile
from bikesim.errors import InputError

PROFILE = """\
# My bench.
[bus]
interface = "virtual"
channel = "x"  # of the lab

[bar]  # the handlebar
inertia = 0.23  # by the swing test
delay=0.003

[drive]
kind = "odrive"
node = 3
torque_constant = 0.055
torque_limit = 3.5
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(PROFILE)
    return path


def test_only_what_is_meant_changes(path: Path):
    kept = change_profile(path, {"bar.inertia": 0.2, "bar.delay": 0.0042})
    text = path.read_text()
    assert text == PROFILE.replace("0.23 ", "0.2 ").replace("delay=0.003", "delay=0.0042")
    assert load_bench(str(path)).bar.inertia == 0.2
    assert kept.read_text() == PROFILE
    assert kept.name.startswith("mine.toml.2")
    assert kept.suffix == ".bak"


def test_a_key_that_was_not_there_comes_in_its_table(path: Path):
    change_profile(path, {"bar.coulomb_friction": 0.03})
    assert load_bench(str(path)).bar.coulomb_friction == 0.03


def test_a_table_that_was_not_there_too():
    assert changed_text(PROFILE, {"thresholds.late": 0.002}).endswith(
        "[thresholds]\nlate = 0.002\n"
    )


def test_two_changes_in_a_second_keep_both_old_ones(path: Path):
    kept = [change_profile(path, {"bar.inertia": one}) for one in (0.21, 0.22, 0.24)]
    assert len(set(kept)) == 3


@pytest.mark.parametrize("first", ["", '\ncommissioned = "old" # then\n', "\nperiod = 0.002\n"])
def test_a_key_of_no_table(first: str):
    text = PROFILE.replace("\n", first or "\n", 1)
    changed = changed_text(text, {"commissioned": "new"})
    assert tomllib.loads(changed) == {**tomllib.loads(text), "commissioned": "new"}
    assert changed.startswith("# My bench.\n")
    assert ("# then" in changed) == ("# then" in text)
    assert tomllib.loads(changed_text(changed, {"commissioned": ""}))["commissioned"] == ""


def test_what_is_no_profile_any_more_is_not_written(path: Path):
    with pytest.raises(InputError, match="inertia"):
        change_profile(path, {"bar.inertia": -1.0})
    assert path.read_text() == PROFILE
    assert [one.name for one in path.parent.iterdir()] == ["mine.toml"]


def test_a_profile_written_in_another_way_is_left_to_its_owner(path: Path):
    inline = PROFILE.replace("[bar]  # the handlebar\ninertia = 0.23  # by the swing test\n", "")
    inline = "bar.inertia = 0.23\n" + inline.replace("delay=0.003\n", "")
    path.write_text(inline)
    with pytest.raises(InputError):
        change_profile(path, {"bar.inertia": 0.2})
    assert path.read_text() == inline


def test_one_that_ships_is_to_be_copied_first():
    with pytest.raises(InputError, match="ships with bikesim; copy a profile"):
        own_profile("cia402-emulated")
