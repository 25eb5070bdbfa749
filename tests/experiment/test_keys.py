import pytest

from bikesim.experiment.keys import scenario_keys
from bikesim.experiment.scenario import Scenario


@pytest.fixture(scope="module")
def keys():
    return {row.key: row for row in scenario_keys()}


def test_each_once(keys):
    assert len(keys) == len(scenario_keys())


@pytest.mark.parametrize(
    "key", ["bicycle", "speed", "rider.visual_delay", "rig.motor_lag", "start.roll_deg",
            "pushes.impulse", "guard.torque_limit", "rider.script.file", "rider.script.torque"],
)  # fmt: skip
def test_tables_with_a_dot(keys, key: str):
    assert keys[key].meaning


def test_each_says_what_it_is(keys):
    assert [row.key for row in keys.values() if not row.meaning.strip()] == []


def test_defaults_are_those_of_a_scenario(keys):
    scenario = Scenario()
    for key in ("speed", "law", "duration", "seed", "guard.torque_limit", "start.roll_deg"):
        table, _, name = key.rpartition(".")
        of = getattr(scenario, table) if table else scenario
        assert keys[key].default == str(getattr(of, name))


def test_what_has_no_default_must_be_given(keys):
    assert keys["pushes.time"].default == "must be given"
