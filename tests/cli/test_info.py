import os
import tomllib
from pathlib import Path

import pytest

from bikesim import __version__, bicycles
from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.scenario import Push, Scenario
from bikesim.record.reader import open_run
from bikesim.rider.script_settings import ScriptSettings


def test_without_a_record_the_names_there_are(cli):
    said = cli("info")
    assert said.status == 0
    for name in ("benchmark", "davis", "human", "hands-off", "schwab2013-184", "delft2013"):
        assert name in said.out
    assert "bikesim info --keys" in said.out


def test_the_names_as_json(cli):
    names = cli("info", "--json").json
    assert set(names) == {"bicycles", "riders", "rigs"}
    assert names["bicycles"] == list(bicycles.names())
    assert len([name for name in names["riders"] if name.startswith("schwab2013-")]) == 15


def keys_of(model, prefix: str = "") -> set[str]:
    """An independent walk through the models: tables into their keys."""
    found = set()
    for name, field in model.model_fields.items():
        inner = getattr(field.annotation, "model_fields", None)
        found |= keys_of(field.annotation, f"{prefix}{name}.") if inner else {f"{prefix}{name}"}
    return found


def test_keys_lists_every_key_of_a_scenario(cli):
    rows = cli("info", "--keys", "--json").json
    tables = {"pushes.": Push, "disturbances.": Disturbance, "rider.script.": ScriptSettings}
    within = set().union(*(keys_of(model, prefix) for prefix, model in tables.items()))
    # The script, which most riders have not, stands there by its keys.
    expected = (keys_of(Scenario) | within) - {"rider.script"}
    assert {row["key"] for row in rows} == expected
    assert all(row["meaning"] for row in rows)


def test_keys_for_people_one_a_line_with_its_default(cli):
    lines = cli("info", "--keys").out.splitlines()
    (line,) = (line for line in lines if line.startswith("speed "))
    assert "Forward speed [m/s]." in line
    assert "3.5" in line


def test_a_record_for_people(cli, record: Path):
    lines = cli("info", "run.h5").out.splitlines()
    assert lines[0] == "run.h5: 1000 ticks of 0.001 s; end of run"
    assert "  bicycle: benchmark" in lines
    assert "  seed: 1" in lines
    (roll,) = (line for line in lines if line.startswith("roll "))
    assert "rad" in roll
    assert "> 0 leans right" in roll


def test_a_record_as_json(cli, record: Path):
    about, run = cli("info", "run.h5", "--json").json, open_run(record)
    expected = {
        "complete": True, "reason": "end of run", "fell": False, "fall_time_s": None,
        "ticks": 1000, "period_s": 0.001, "bicycle": "benchmark", "law": "paper",
        "rider": "human", "rig": "ideal", "seed": 1, "digest": run.digest(),
    }  # fmt: skip
    assert {key: about[key] for key in expected} == expected
    assert about["last_time_s"] == pytest.approx(0.999)
    assert about["versions"]["bikesim"] == __version__
    assert about["handlebar_inertia_kg_m2"] == pytest.approx(0.23108501173, abs=1e-11)
    assert [channel["name"] for channel in about["channels"]] == list(run.names)
    assert all(set(c) == {"name", "unit", "sign", "description"} for c in about["channels"])


def test_the_scenario_of_a_record_is_toml_of_every_figure(cli, record: Path):
    scenario = tomllib.loads(cli("info", "run.h5", "--scenario").out)
    assert scenario["duration"] == 1
    assert scenario["pushes"] == [
        {"time": 0.2, "impulse": 5, "duration": 0.1, "height": 0.9, "ahead": 0.3}
    ]
    assert scenario["rider"]["visual_delay"] == 0.2


def test_a_bicycle_as_our_toml(cli):
    shown = tomllib.loads(cli("info", "--bicycle", "benchmark").out)
    assert cli("info", "--bicycle", "benchmark", "--json").json == shown


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scenario"], "info --scenario: a record is missing"),
        (["--bicycle", "nix"], "unknown bicycle 'nix'; known: benchmark"),
        (["--keys", "run.h5"], "takes a record, --keys or --bicycle, one of them at a time"),
        (["--bicycle", "davis", "run.h5"], "one of them at a time"),
        (["--kezs"], "unknown option --kezs; did you mean --keys?"),
    ],
    ids=str,
)
def test_what_cannot_be_asked(refusal, arguments: list, message: str):
    assert message in refusal("info", *arguments)


def test_a_pipe_is_no_record(refusal, tmp_path: Path):
    os.mkfifo(tmp_path / "pipe")
    assert "pipe: is not a plain file, so not a run file" in refusal("info", "pipe")
