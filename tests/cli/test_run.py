import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bikesim.record.reader import open_run
from bikesim.rig.base import Sample
from bikesim.rig.virtual import VirtualRig

KEYS = {
    "record": str,
    "fell": bool,
    "fall_time_s": float | None,
    "ticks": int,
    "rms_roll_rad": float,
    "rms_steer_rad": float,
    "rms_feedback_torque_N_m": float,
    "sim_over_wall": float,
}
SHORT = ("--duration", 0.3, "--output", "run.h5")


@pytest.fixture
def digest(cli):
    """The digest of a run with these arguments."""

    def of(*arguments: object) -> str:
        assert cli("run", *arguments, "--output", "digested.h5", "--force").status == 0
        return open_run("digested.h5").digest()

    return of


@pytest.fixture(scope="module")
def default_summary(tmp_path_factory):
    """What the default scenario comes to, and its record."""
    folder = tmp_path_factory.mktemp("default")
    command = [sys.executable, "-m", "bikesim", "run", "--json"]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    summary = json.loads(ran.stdout)
    return summary, open_run(folder / summary["record"])


class TestDefaultScenario:
    @pytest.mark.parametrize("key", KEYS)
    def test_json_has_the_keys_that_others_rely_on(self, default_summary, key: str):
        summary, _ = default_summary
        assert isinstance(summary[key], KEYS[key])

    def test_the_rider_keeps_the_benchmark_up_for_30_s(self, default_summary):
        summary, run = default_summary
        assert (summary["fell"], summary["fall_time_s"]) == (False, None)
        assert summary["ticks"] == run.ticks == 30_000
        assert (run.bicycle.name, run.law, run.rider, run.rig) == (
            "benchmark", "paper", "human", "ideal",
        )  # fmt: skip
        assert set(run.channel("speed")) == {3.5}

    def test_the_record_lies_in_runs_under_date_and_time(self, default_summary):
        summary, _ = default_summary
        assert summary["record"].startswith("runs/")
        assert summary["record"].endswith(".h5")

    @pytest.mark.parametrize(
        ("key", "channel"),
        [
            ("rms_roll_rad", "roll"),
            ("rms_steer_rad", "steer"),
            ("rms_feedback_torque_N_m", "sent_torque"),
        ],
    )
    def test_root_mean_squares_are_those_of_the_record(self, default_summary, key, channel):
        summary, run = default_summary
        values = run.channel(channel)
        assert summary[key] == pytest.approx(math.sqrt(sum(v * v for v in values) / len(values)))

    def test_the_ride_is_that_of_a_person(self, default_summary):
        """Roll of some degrees, and torques within the ±5 N m measured in ordinary riding."""
        summary, run = default_summary
        assert math.radians(0.5) < summary["rms_roll_rad"] < math.radians(5)
        assert np.abs(run.channel("rider_torque")).max() < 5
        assert np.abs(run.channel("sent_torque")).max() < 5

    def test_it_runs_faster_than_real_time(self, default_summary):
        summary, _ = default_summary
        assert summary["sim_over_wall"] > 1

    def test_another_process_gives_the_same_run_bit_for_bit(self, default_summary, cli):
        _, run = default_summary
        assert cli("run", "--output", "again.h5").status == 0
        assert open_run("again.h5").digest() == run.digest()


def test_with_haptics_off_the_same_rider_falls(cli):
    summary = cli("run", "--law", "off", "--json").json
    run = open_run(summary["record"])
    assert summary["fell"] is True
    assert summary["fall_time_s"] == run.time[-1] < 30
    assert summary["ticks"] == run.ticks == len(run.time)
    assert np.all(run.channel("sent_torque") == 0)


def test_a_fall_is_told_as_a_result(cli):
    said = cli("run", "--law", "off")
    assert (said.status, said.err) == (0, "")
    assert "haptics off, rider human" in said.out
    assert "fell" in said.out


def test_a_run_that_stays_up_is_told_so(cli):
    said = cli("run", *SHORT)
    assert (said.status, said.err) == (0, "")
    assert "benchmark at 3.5 m/s, law paper, rider human, rig ideal" in said.out
    assert "stayed up (0.300 s, 300 ticks)" in said.out
    assert "record  run.h5" in said.out


REALISTIC = ("--duration", 0.5, "--rig", "delft2013")


def test_the_same_seed_gives_the_same_run_on_a_noisy_rig(digest):
    assert digest(*REALISTIC, "--seed", 5) == digest(*REALISTIC, "--seed", 5)


def test_another_seed_gives_another_run(digest):
    assert digest(*REALISTIC, "--seed", 5) != digest(*REALISTIC, "--seed", 6)


@pytest.mark.parametrize(
    ("option", "value", "found"),
    [
        ("--bicycle", "davis", lambda run: run.bicycle.name),
        ("--law", "momentum", lambda run: run.law),
        ("--rider", "schwab2013-184", lambda run: run.rider),
        ("--rig", "delft2013", lambda run: run.rig),
        ("--seed", 7, lambda run: run.seed),
        ("--speed", 4.2, lambda run: run.channel("speed")[0]),
        ("--gravity", 9.5, lambda run: run.bicycle.gravity),
        ("--period", 0.005, lambda run: run.period),
        ("--roll-deg", 2.0, lambda run: round(math.degrees(run.channel("roll")[0]), 9)),
    ],
)
def test_each_option_comes_through(cli, option: str, value, found):
    assert cli("run", *SHORT, option, value).status == 0
    assert found(open_run("run.h5")) == value


def test_duration_in_ticks(cli):
    assert cli("run", *SHORT, "--json").json["ticks"] == 300


def test_a_finer_physics_changes_the_run_a_little(cli):
    cli("run", *SHORT, "--rider", "pd", "--roll-deg", 1)
    cli("run", *SHORT[:2], "--rider", "pd", "--roll-deg", 1, "--physics-step", 1e-4, "-o", "f.h5")
    rough, fine = open_run("run.h5").channel("roll"), open_run("f.h5").channel("roll")
    assert 0 < np.abs(rough - fine).max() < 1e-4


def test_a_push_of_an_impulse_at_a_height(cli):
    """Roll moment over time: impulse × 0.9 m, where the half sine lies between its times."""
    cli("run", *SHORT, "--push", "0.1:2")
    run = open_run("run.h5")
    moment = run.channel("roll_moment")
    assert moment.sum() * run.period == pytest.approx(2 * 0.9, rel=1e-3)
    assert set(np.flatnonzero(moment)) <= set(range(100, 201))


def test_several_pushes(cli):
    cli("run", *SHORT, "--push", "0:2", "--push", "0.15:-2")
    moment = open_run("run.h5").channel("roll_moment")
    assert (moment.max(), moment.min()) == pytest.approx((28.27, -28.27), abs=0.02)


def test_any_key_by_set(cli):
    cli("run", *SHORT, "--set", "rider.visual_delay=0.3", "--set", "rig.torque_limit=3.5")
    scenario = open_run("run.h5").scenario
    assert "visual_delay = 0.3" in scenario
    assert "torque_limit = 3.5" in scenario


def test_a_figure_of_a_named_rider_beside_his_name(cli):
    cli("run", *SHORT, "--rider", "pd", "--set", "rider.roll_gain=0.5")
    scenario = open_run("run.h5").scenario
    assert 'name = "pd"' in scenario
    assert "roll_gain = 0.5" in scenario


def test_a_path_by_its_kind_and_figures(cli):
    said = cli("run", "--path", "lane-change", "--set", "path.offset=1.5", *SHORT).out
    assert said.startswith(
        "benchmark at 3.5 m/s, law paper, rider human, rig ideal, path lane-change\n"
    )
    assert "offset = 1.5\n" in open_run("run.h5").scenario


def test_a_path_from_a_file(cli):
    Path("track.csv").write_text("x,y\n0,0\n8,0\n16,1\n30,1\n")
    assert ", path track.csv\n" in cli("run", "--path", "track.csv", *SHORT).out


def test_cues_that_are_not_as_usual_are_told(cli):
    said = cli("run", "--set", "haptics.delay=0.05", "--set", "vision.roll_cue=false", *SHORT).out
    assert "\ncues    haptics.delay = 0.05, vision.roll_cue = false\n" in said
    assert "cues" not in cli("run", *SHORT, "--force").out


def test_a_rig_of_another_inertia_is_named_with_what_it_does(cli):
    said = cli("run", *SHORT, "--rig", "phobos")
    assert said.status == 0
    assert said.err.startswith("note: the rig's handlebar inertia is 0.0427 kg m²")
    assert said.err.endswith("1/s off the bicycle's\n")
    assert said.err.count("\n") == 1


def test_a_faulty_sensor_is_an_error_that_keeps_the_record(cli, monkeypatch):
    def broken(rig: VirtualRig) -> Sample:
        sample = read(rig)
        return sample if sample.time < 0.1 else Sample(sample.time, math.nan, math.nan)

    read = VirtualRig.read
    monkeypatch.setattr(VirtualRig, "read", broken)
    said = cli("run", *SHORT)
    assert said.status == 2
    assert said.err.startswith("bikesim: fault: feedback torque is nan at tick 101")
    assert said.err.endswith("kept: run.h5\n")
    run = open_run("run.h5")
    assert run.complete
    assert run.ending is not None
    assert run.ending.reason.startswith("fault")
    assert run.channel("sent_torque")[-1] == 0
