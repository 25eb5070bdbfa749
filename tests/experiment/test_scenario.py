import tomllib
from pathlib import Path
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


class TestTasksAndCues:
    @pytest.mark.parametrize(
        "keys",
        [
            {"path": "circle", "haptics": {"switches": [[1, 0], [2, 1.5]], "limit": 3}},
            {
                "path": {
                    "kind": "csv",
                    "points": [[0, 0], [5, 0.1], [9.123456789, 1], [20, 3]],
                }
            },
            {"vision": {"roll_cue": False, "preview": 2, "occlusions": [[1, 2], [3, 4.5]]}},
            {"disturbances": [{"kind": "gust"}, {"kind": "steer-multisine", "stop": 4}]},
            {"start": {"steer_deg": 3}, "speed_profile": [[0, 3], [9, 4]]},
        ],
    )
    def test_as_toml_it_is_the_same_again(self, keys: dict[str, Any]):
        scenario = _scenario(**keys)
        assert Scenario(**tomllib.loads(to_toml(scenario))) == scenario

    def test_pairs_of_numbers_take_a_line_each(self):
        text = to_toml(_scenario(speed_profile=[[0, 3], [1e-5, 4]]))
        assert "    [0.0, 3.0],\n    [1e-05, 4.0],\n" in text

    def test_a_path_by_kind_or_by_file(self, tmp_path: Path):
        (tmp_path / "track.csv").write_text("0,0\n5,0\n10,1\n20,1\n")
        assert _scenario(path="slalom").path.amplitude == 1
        path = _scenario(path=str(tmp_path / "track.csv")).path
        assert (path.kind, path.points) == ("csv", ((0, 0), (5, 0), (10, 1), (20, 1)))

    def test_it_needs_the_file_of_its_path_no_more(self, tmp_path: Path):
        track = tmp_path / "track.csv"
        track.write_text("0,0\n5,0\n10,1\n20,1\n")
        scenario = _scenario(path=str(track))
        track.unlink()
        assert Scenario(**tomllib.loads(to_toml(scenario))) == scenario

    @pytest.mark.parametrize(
        "text", ['path = "track.csv"', '[path]\nfile = "track.csv"\nkind="csv"']
    )
    def test_a_file_is_sought_beside_the_scenario(self, tmp_path: Path, text: str):
        (tmp_path / "track.csv").write_text("0,0\n5,0\n10,1\n20,1\n")
        (tmp_path / "ride.toml").write_text(text)
        path = _scenario(**read_toml(tmp_path / "ride.toml")).path
        assert path.file == str(tmp_path / "track.csv")
        assert path.points is not None
        assert len(path.points) == 4

    def test_where_there_is_none_it_is_sought_where_we_are(self, tmp_path: Path, monkeypatch):
        (tmp_path / "sub").mkdir()
        (tmp_path / "track.csv").write_text("0,0\n5,0\n10,1\n20,1\n")
        (tmp_path / "sub" / "ride.toml").write_text('path = "track.csv"')
        monkeypatch.chdir(tmp_path)
        assert _scenario(**read_toml(tmp_path / "sub" / "ride.toml")).path.file == "track.csv"

    @pytest.mark.parametrize(
        ("keys", "told"),
        [
            ({"start": {"steer_deg": 60}}, "start.steer_deg = 60.0: must be within the rig's"),
            ({"path": 3}, "path = 3: must be a name or a table"),
            ({"haptics": {"delay": 0.0004}}, "haptics.delay = 0.0004 s: must be 0 or at least"),
            ({"haptics": {"filter_cutoff": 5e3}}, "haptics.filter_cutoff = 5000.0 rad/s: must be"),
            (
                {"disturbances": [{"kind": "roll-multisine", "highest": 40}], "period": 0.1},
                "disturbances.highest = 40.0 rad/s: must be below 31.4159 rad/s",
            ),
            ({"disturbances": [{}]}, "disturbances.kind: must be given"),
            ({"disturbances": 3}, "disturbances = 3: must be a list"),
        ],
    )  # fmt: skip
    def test_refused_in_one_line(self, keys: dict[str, Any], told: str):
        with pytest.raises(InputError) as refused:
            _scenario(**keys)
        assert str(refused.value).startswith(told)
