"""`bikesim identify rider`, on records of the virtual rig."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from bikesim.cli.main import main

SCENARIO = """\
bicycle = "davis"
speed = 3.19
duration = 40
rider = { name = "schwab2013-184", remnant_rms = 0.1 }
[[disturbances]]
kind = "roll-multisine"
"""
# [S13], run 184.
GAINS = {"k_phi": 22.72, "k_phi_dot": 26.12, "k_int": 65.92, "k_delta_dot": -3.0}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("identify")
    (folder / "scenario.toml").write_text(SCENARIO)
    path = folder / "ridden.h5"
    assert main(["run", str(folder / "scenario.toml"), "--output", str(path)]) == 0
    return path


@pytest.fixture
def run(recorded: Path, tmp_path: Path) -> Path:
    copy = tmp_path / "run.h5"
    copy.write_bytes(recorded.read_bytes())
    return copy


def test_json_has_the_keys_that_others_rely_on(cli, run: Path):
    found = cli("identify", "rider", run, "--json").json
    assert set(found) >= {
        "records", "bicycle", "speed_m_s", "law", "structure", "method", "torque", "duration_s",
        "confidence", "gains", "held", "vaf_percent", "least_squares_vaf_percent", "noise_rms_N_m",
        "excited_frequencies", "condition_number", "correlation", "warnings",
    }  # fmt: skip
    assert (found["bicycle"], found["method"], found["torque"]) == (
        "davis", "instrumental-variable", "rider",
    )  # fmt: skip
    assert {gain["name"] for gain in found["gains"]} == set(GAINS)
    for gain in found["gains"]:
        assert abs(gain["value"] - GAINS[gain["name"]]) < 3.5 * gain["standard_error"]
        assert gain["low"] < gain["value"] < gain["high"]
        assert set(gain) >= {"unit", "least_squares"}
    assert found["vaf_percent"] > 95
    assert list(run.parent.iterdir()) == [run]  # JSON alone draws nothing


def test_the_bar_gives_what_the_channel_gives(cli, run: Path):
    channel, bar = (
        cli("identify", "rider", run, "--json", "--torque", source).json
        for source in ("rider", "bar")
    )
    for one, other in zip(channel["gains"], bar["gains"], strict=True):
        assert abs(one["value"] - other["value"]) < 0.5 * one["standard_error"]


def test_a_record_of_a_bench_that_knows_only_bar_and_motor(cli, run: Path):
    with h5py.File(run, "r+") as file:
        for name in ("rider_torque", "true_steer", "true_steer_rate", "motor_torque"):
            del file[f"channels/{name}"]
    found = cli("identify", "rider", run, "--json").json
    assert found["torque"] == "bar"
    for gain in found["gains"]:
        assert abs(gain["value"] - GAINS[gain["name"]]) < 3.5 * gain["standard_error"]


def test_a_table_and_a_figure(cli, run: Path):
    said = cli("identify", "rider", run)
    assert (said.status, said.err) == (0, "")
    for text in ("k_delta_dot", "N m s/rad", "95 % interval", "least squares", "biased", "VAF"):
        assert text in said.out
    assert "figure  rider-run.png" in said.out
    assert (run.parent / "rider-run.png").stat().st_size > 20_000
    assert "not drawn: rider-run.png: is already there" in cli("identify", "rider", run).out


def test_several_records_and_a_named_figure(cli, run: Path):
    other, scenario = run.with_name("other.h5"), run.with_name("scenario.toml")
    scenario.write_text(SCENARIO)
    assert main(["run", str(scenario), "--seed", "2", "--output", str(other)]) == 0
    said = cli("identify", "rider", run, other, "--figure", "both.svg", "--confidence", 0.9)
    assert "and 1 more" in said.out
    assert "90 % interval" in said.out
    assert (run.parent / "both.svg").exists()


def test_a_record_under_two_names_is_not_two(cli, run: Path):
    other = run.with_name("other.h5")
    other.write_bytes(run.read_bytes())
    refused = cli("identify", "rider", run, other)
    assert refused.status == 2
    assert (
        refused.err == f"bikesim: {other}: the same ride as {run}, by its signals; it counts once\n"
    )


def test_a_lag_that_is_free(cli, run: Path):
    found = cli("identify", "rider", run, "--muscle", "free", "--json").json
    (muscle,) = (gain for gain in found["gains"] if gain["name"] == "muscle_frequency")
    assert abs(muscle["value"] - 13.6345) < 3.5 * muscle["standard_error"]
    assert set(found["held"]) == {"delay", "muscle_damping_ratio"}


def test_a_recording_without_a_known_disturbance_is_answered_with_a_warning(cli, shared: Path):
    said = cli(
        "identify", "rider", shared / "recordings" / "phobos_5mps.csv.gz",
        "--bicycle", "benchmark", "--gravity", 9.80665, "--inertia", 0.0427,
    )  # fmt: skip
    assert (said.status, said.err) == (0, "")
    assert "warning: no known disturbance is in the record, so only a fit that may be" in said.out
    assert "prediction-error" in said.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["raider", "run.h5"], "unknown thing to identify 'raider'; did you mean rider?"),
        (["rider"], "RUN.h5 is missing"),
        (["rider", "none.h5"], "none.h5: no such file"),
        (["rider", "run.h5", "--structure", "pid"], "unknown structure 'pid'; "),
        (["rider", "run.h5", "--method", "iv"], "unknown method 'iv'; "),
        (["rider", "run.h5", "--torque", "arm"], "--torque arm: must be rider or bar"),
        (["rider", "run.h5", "--delay", "some"], "--delay some: must be a number or free"),
        (["rider", "run.h5", "--delay", "nan"], "delay = nan: free, or from 0 to 1"),
        (["rider", "run.h5", "--muscle", "1"], "muscle_frequency = 1.0: free, or from 2 to 200"),
        (["rider", "run.h5", "--confidence", "2"], "confidence = 2.0: from 0.5 to below 1"),
        (["rider", "run.h5", "--inertia", "-1"], "--inertia -1.0: must be above 0"),
        (["rider", "run.h5", "--law", "none"], "--law none: must be one of paper, momentum, off"),
        (["rider", "run.h5", "--bicycle", "trike"], "unknown bicycle 'trike'"),
        (["rider", "run.h5", "--figure", "run.h5"], "run.h5: would replace what this command"),
        (["rider", "run.h5", "--figure", "a.jpg"], "a.jpg: cannot draw to '.jpg'"),
        (["rider", "run.h5", "--arms", "--torque", "rider"], "leave --torque out"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused(refusal, run: Path, arguments: list[str], message: str):
    del run
    assert message in refusal("identify", *arguments)


def test_records_that_cannot_be_identified(refusal, cli, run: Path):
    assert cli("run", "--duration", 3, "--output", "still.h5").status == 0
    assert "still.h5: bicycle benchmark, but run.h5 has davis: identify them apart" in refusal(
        "identify", "rider", "run.h5", "still.h5"
    )
    assert "still.h5: 3.00 s: too short for 4 gains" in refusal("identify", "rider", "still.h5")
    assert "no disturbance is in the record" in refusal(
        "identify", "rider", "still.h5", "--method", "instrumental-variable"
    )
    with h5py.File(run, "r+") as file:
        channels = file["channels"]
        assert isinstance(channels, h5py.Group)
        values = channels["rider_torque"]
        assert isinstance(values, h5py.Dataset)
        values[5] = np.inf
    assert "run.h5: rider_torque is inf at 0.005 s" in refusal("identify", "rider", "run.h5")
    with h5py.File(run, "r+") as file:
        del file["channels/roll"]
    assert "run.h5: channel roll is missing" in refusal("identify", "rider", "run.h5")
