import tomllib
from typing import Any

import pytest

from bikesim.errors import InputError
from bikesim.experiment.scenario import Push, Scenario, read_toml, to_toml


def _scenario(**keys: Any) -> Scenario:
    return Scenario(**keys)


def test_an_empty_scenario_is_the_default_run():
    scenario = Scenario()
    assert (scenario.bicycle, scenario.speed, scenario.law) == ("benchmark", 3.5, "paper")
    assert (scenario.duration, scenario.ticks) == (30, 30_000)
    assert (scenario.rider.name, scenario.rider.visual_delay) == ("human", 0.2)
    assert (scenario.rig.name, scenario.rig.inertia) == ("ideal", None)


def test_a_rider_and_a_rig_by_name_have_their_figures():
    scenario = _scenario(rider="pd", rig="delft2013")
    assert scenario.rider.visual_delay == 0
    assert scenario.rig.angle_resolution > 0


def test_figures_beside_a_name_replace_those_of_the_name():
    pd = _scenario(rider="pd").rider
    changed = _scenario(rider={"name": "pd", "visual_delay": 0.1}).rider
    assert pd.visual_delay != changed.visual_delay == 0.1
    assert changed == pd.model_copy(update={"visual_delay": 0.1})


@pytest.mark.parametrize(
    ("duration", "period", "ticks"), [(30, 0.001, 30_000), (0.01, 0.01, 1), (1, 0.003, 333)]
)
def test_ticks_of_a_run(duration: float, period: float, ticks: int):
    assert Scenario(duration=duration, period=period).ticks == ticks


SCENARIOS = {
    "default": {},
    "everything": {
        "bicycle": "davis", "gravity": 9.7, "law": "off", "duration": 3, "seed": 2**62,
        "speed_profile": [[0, 3], [10, 5.5]], "period": 0.005, "physics_step": 0.0025,
        "rider": {"name": "schwab2013-184", "remnant_rms": 0.1},
        "rig": {"name": "phobos", "inertia": 0.1}, "start": {"roll_deg": -3.3},
        "pushes": [{"time": 1, "impulse": -2}, {"time": 2, "impulse": 1, "ahead": 0}],
        "guard": {"torque_limit": 3},
    },
    "hands off": {"rider": "hands-off"},
}  # fmt: skip


@pytest.mark.parametrize("keys", SCENARIOS.values(), ids=list(SCENARIOS))
def test_toml_gives_the_same_scenario_again(keys: dict):
    scenario = Scenario(**keys)
    assert Scenario(**tomllib.loads(to_toml(scenario))) == scenario


def test_toml_has_every_figure_that_counts():
    resolved = tomllib.loads(to_toml(Scenario()))
    assert resolved["rider"]["arm_stiffness"] == 5
    assert resolved["guard"]["torque_rate_limit"] == 300
    assert resolved["rig"]["steer_stop_deg"] == 60


def test_it_cannot_be_changed():
    with pytest.raises(ValueError, match="frozen"):
        Scenario().speed = 4


def test_a_push_that_is_none_is_refused_by_its_own_name():
    with pytest.raises(InputError, match=r"pushes\.impulse: must be given"):
        Push(time=1)  # pyright: ignore[reportCallIssue]


def test_a_profile_must_rise():
    with pytest.raises(InputError, match=r"times must rise from pair to pair, not \[1\.0, 0\.0\]"):
        Scenario(speed_profile=((1, 3), (0, 3)))


def test_a_file_is_read_as_toml(tmp_path):
    (tmp_path / "s.toml").write_text("speed = 4 # φ\n", "utf-8")
    assert read_toml(tmp_path / "s.toml") == {"speed": 4}


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(InputError, match=r"scenario .*s\.toml: no such file or directory"):
        read_toml(tmp_path / "s.toml")
