import math
import re
from pathlib import Path

import numpy as np
import pytest

from bikesim.experiment.batch import ride_batch
from bikesim.experiment.history import History
from bikesim.experiment.metric_table import METRICS
from bikesim.experiment.metrics import Metrics, measure, measure_many
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.summary import summarise
from bikesim.path.building import make_path
from bikesim.path.path import path_points
from bikesim.path.settings import PathSettings
from bikesim.record.header import Ending

PLAIN = Scenario()


def test_the_table_has_each_metric_in_order():
    assert tuple(metric.name for metric in METRICS) == Metrics._fields


def test_the_page_shows_the_table(repository: Path):
    lines = (repository / "docs" / "metrics.md").read_text(encoding="utf-8").splitlines()
    rows = [re.split(r" (?<!\\)\| ", line.strip("| ")) for line in lines if line[:3] == "| `"]
    assert rows == [[f"`{m.name}`", m.unit, m.definition, m.source] for m in METRICS]


def test_at_rest_nothing_is_anything(made_up):
    metrics = measure(made_up(20), PLAIN)
    for name in Metrics._fields:
        value = getattr(metrics, name)
        assert value == (20.0 if name == "duration" else 0.0) or math.isnan(value), name


def test_root_mean_squares_of_sines(made_up):
    signals = {
        "roll": 0.1, "roll_rate": 0.2, "true_steer": 0.3, "true_steer_rate": 0.4,
        "sent_torque": 0.5, "rider_torque": 0.6, "y": 0.7,
    }  # fmt: skip
    waves = {n: (lambda t, a=a: a * np.sin(2 * np.pi * t)) for n, a in signals.items()}
    metrics = measure(made_up(20, **waves), PLAIN)
    names = (
        "roll_rms", "roll_rate_rms", "steer_rms", "steer_rate_rms", "feedback_torque_rms",
        "rider_torque_rms", "lateral_rms",
    )  # fmt: skip
    for name, amplitude in zip(names, signals.values(), strict=True):
        assert getattr(metrics, name) == pytest.approx(amplitude / math.sqrt(2)), name


def test_what_the_sensors_make_of_the_bar_is_of_no_account(made_up):
    """Noise of 2.3 deg on a bar that turns by 0.6 deg is no steering."""
    noise = np.random.default_rng(1).normal(0, 0.04, 2000)
    moves = {"true_steer": lambda t: 0.01 * np.sin(t), "true_steer_rate": np.cos}
    metrics = measure(made_up(steer=noise, steer_rate=noise, **moves), PLAIN)
    np.testing.assert_array_equal(metrics, measure(made_up(**moves), PLAIN))
    assert metrics.steer_reversals == 0


def test_a_filter_in_the_sensor_is_not_in_the_steer_metrics(ridden):
    """A slow filter hides most of a fast bar from the loop; single runs and batches agree on it."""
    keys = {"rig": {"filter_cutoff": 5.0}, "start": {"roll_deg": 5}, "duration": 2.0}
    record = ridden(**keys)
    scenario = Scenario(**keys)
    alone = measure(History.of_run(record), scenario)
    (outcome,) = ride_batch([scenario])
    together = measure(outcome.history, scenario)
    true, sensed = (record.channel(n)[::10] for n in ("true_steer_rate", "steer_rate"))
    assert np.std(sensed) < 0.9 * np.std(true)
    for found in (alone, together):
        assert found.steer_rate_rms == pytest.approx(np.linalg.norm(true) / math.sqrt(len(true)))
    assert summarise(record).rms_steer == pytest.approx(alone.steer_rms, rel=1e-2)


def test_lateral_position(made_up):
    metrics = measure(made_up(20, y=lambda t: 0.3 - 0.4 * np.sin(2 * np.pi * t)), PLAIN)
    assert metrics.lateral_mean == pytest.approx(0.3)
    assert metrics.sdlp == pytest.approx(0.4 / math.sqrt(2))
    assert metrics.lateral_rms == pytest.approx(math.hypot(0.3, 0.4 / math.sqrt(2)))
    assert metrics.lateral_max == pytest.approx(0.7)


def test_lateral_position_is_that_beside_the_path(made_up):
    """Straight on where the path of radius 20 m goes to the right: it ends up to its left."""
    scenario = Scenario(path=PathSettings(kind="circle"))
    history = made_up(8, x=lambda t: 5 * t, speed=5.0)
    metrics = measure(history, scenario)
    points = path_points(make_path(scenario.path), 0.0, 60.0, apart=0.01)
    farthest = np.hypot(*(points - [history.x[-1], 0.0]).T).min()
    assert metrics.lateral_max == pytest.approx(farthest, abs=1e-3)
    assert metrics.lateral_mean < 0 < farthest


def test_a_fall(made_up):
    ending = Ending("fell to the right: roll beyond 45 deg", fell=True, fall_time=4.5)
    metrics = measure(made_up(4.51, ending=ending), PLAIN)
    assert (metrics.fell, metrics.fall_time) == (1.0, 4.5)
    assert metrics.duration == pytest.approx(4.51)
    assert math.isnan(metrics.torque_power_low)


def test_reversals_and_work(made_up):
    metrics = measure(
        made_up(
            10,
            true_steer=lambda t: 0.05 * np.sin(2 * np.pi * t),
            steer_rate=lambda t: 0.1 * np.pi * np.sin(2 * np.pi * t),  # late: of no account
            true_steer_rate=lambda t: 0.1 * np.pi * np.cos(2 * np.pi * t),
            rider_torque=lambda t: np.cos(2 * np.pi * t),
        ),
        PLAIN,
    )
    assert metrics.steer_reversals == pytest.approx(2.0, abs=0.1)
    assert metrics.work_net == pytest.approx(0.1 * np.pi * 5, rel=0.01)
    assert metrics.work_positive == pytest.approx(metrics.work_net)


@pytest.mark.parametrize(
    ("keys", "limit"),
    [
        ({}, 10.0),
        ({"rig": {"torque_limit": 3.0}}, 3.0),
        ({"haptics": {"limit": 1.5}, "rig": {"torque_limit": 3.0}}, 1.5),
        ({"rig": {"torque_limit": 3.0, "torque_resolution": 0.07}}, 2.94),
    ],
)
def test_saturation_at_the_smallest_limit(keys, limit: float, made_up):
    """A torque that is at the limit for a quarter of the time, at ± 0.9 of it else."""
    torque = np.tile([limit, 0.9 * limit, -0.9 * limit, 0.9 * limit], 250)
    metrics = measure(made_up(10, sent_torque=torque), Scenario(**keys))
    assert metrics.saturated == 0.25


def test_the_spectrum_of_the_riders_torque(made_up):
    metrics = measure(
        made_up(60, rider_torque=lambda t: np.sin(2 * np.pi * 0.3 * t) + np.sin(2 * np.pi * 3 * t)),
        PLAIN,
    )
    assert metrics.torque_power_low == pytest.approx(0.5, rel=0.02)
    assert metrics.torque_power_middle < 0.01
    assert metrics.torque_power_high == pytest.approx(0.5, rel=0.02)
    assert metrics.torque_centroid_frequency == pytest.approx(1.65, rel=0.02)


def test_without_a_rider_model_what_is_his_is_not_defined(made_up):
    metrics = measure(made_up(20, rider_torque=np.nan), PLAIN)
    for name in ("rider_torque_rms", "work_net", "torque_power_low", "torque_median_frequency"):
        assert math.isnan(getattr(metrics, name)), name
    assert metrics.roll_rms == 0


def test_a_record_gives_what_its_summary_gives(ridden):
    """The summary takes every tick, the metrics every tenth."""
    record = ridden(duration=20.0, seed=3)
    summary, metrics = summarise(record), measure(History.of_run(record), PLAIN)
    assert metrics.roll_rms == pytest.approx(summary.rms_roll, rel=1e-3)
    assert metrics.steer_rms == pytest.approx(summary.rms_steer, rel=1e-3)
    assert metrics.feedback_torque_rms == pytest.approx(summary.rms_feedback_torque, rel=1e-2)


def test_many_are_the_same_as_one_by_one(made_up):
    histories = [made_up(5, roll=roll) for roll in (0.1, 0.2)]
    many = measure_many(histories, [PLAIN, PLAIN])
    assert [one.roll_rms for one in many] == pytest.approx([0.1, 0.2])
