"""A run in a batch is the run that it is alone."""

from collections.abc import Sequence

import numpy as np
import pytest

from bikesim.experiment.batch import batch_key, ride_batch
from bikesim.experiment.history import SIGNALS, History
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending
from bikesim.rig.virtual import VIRTUAL_CHANNELS

NAMES = [channel.name for channel in (*TICK_CHANNELS, *VIRTUAL_CHANNELS)]
# What np.cos and math.cos may differ in, and so what is integrated from them.
BY_COSINE = ("x", "y")


class Rows:
    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)


def alone(scenario: Scenario) -> tuple[Ending, dict[str, np.ndarray]]:
    rows = Rows()
    ending = ride_parts(build(scenario), rows)
    columns = zip(NAMES, zip(*rows.rows, strict=True), strict=False)
    return ending, {name: np.array(values) for name, values in columns}


def assert_as_alone(scenarios: Sequence[Scenario], *, exactly: bool = True) -> list[Ending]:
    outcomes = ride_batch(scenarios)
    for scenario, (ending, history) in zip(scenarios, outcomes, strict=True):
        ended, channels = alone(scenario)
        assert ending == ended
        assert history.ticks == len(channels["time"])
        for name in SIGNALS:
            expected = channels[name][:: history.every]
            if exactly and name not in BY_COSINE:
                np.testing.assert_array_equal(getattr(history, name), expected, err_msg=name)
            np.testing.assert_allclose(getattr(history, name), expected, rtol=1e-12, atol=1e-12)
    return [outcome.ending for outcome in outcomes]


def several(changes: Sequence[dict], **shared) -> list[Scenario]:
    return [Scenario(duration=3.0, **{**shared, **change}) for change in changes]


def test_seeds():
    endings = assert_as_alone(several([{"seed": k} for k in range(5)]))
    assert {ending.reason for ending in endings} == {"end of run"}


def test_falls_end_one_by_one_and_leave_the_others_alone():
    starts = [0.0, 2.0, -6.0, 12.0, 30.0]
    endings = assert_as_alone(several([{"start": {"roll_deg": roll}} for roll in starts]))
    assert not endings[0].fell
    assert endings[-1].fell


def test_all_fall_with_haptics_off():
    endings = assert_as_alone(several([{"seed": k} for k in range(3)], law="off", speed=3.5))
    starts = several([{"start": {"roll_deg": 20.0 + k}} for k in range(3)], law="off")
    endings = assert_as_alone(starts)
    assert all(ending.fell for ending in endings)


def test_speeds_and_pushes_and_rider_figures():
    changes = [
        {
            "speed": 3.0 + 0.5 * k,
            "rider": {"name": "pd", "roll_gain": 2.0 + k, "visual_delay": 0.01 * k},
            "pushes": ({"time": 0.5 + 0.1 * k, "impulse": 3.0 * k},),
        }
        for k in range(4)
    ]
    assert_as_alone(several(changes))


@pytest.mark.parametrize("law", ["paper", "momentum"])
@pytest.mark.parametrize("rig", ["delft2013", "phobos", "can1khz"])
def test_rigs_and_laws(rig: str, law: str):
    assert_as_alone(several([{"seed": k} for k in range(3)], rig=rig, law=law))


def test_a_slow_loop():
    assert_as_alone(several([{"seed": k} for k in range(3)], period=0.02, physics_step=0.001))


def test_arms_of_each_rider():
    changes = [{"rider": {"name": "human", "arm_stiffness": 5.0 * k}} for k in range(3)]
    assert_as_alone(several(changes))


def test_grips_change_on_the_way():
    grips = ([1.0, "hands-off"], [1.5, "normal"], [2.0, "tight"])
    changes = [{"seed": k, "rider": {"name": "human", "grips": grips}} for k in range(3)]
    assert_as_alone(several(changes, speed=5.0))


def test_identified_riders():
    changes = [{"start": {"roll_deg": roll}} for roll in (-1.0, 0.5, 1.0)]
    rider = {"name": "schwab2013-184", "remnant_rms": 0.3}
    assert_as_alone(several(changes, bicycle="davis", speed=3.19, rider=rider))


def test_a_rider_on_a_path_is_the_same_to_rounding():
    """Where he is on it comes from the cosine of the heading."""
    rider = {"name": "hess2012", "remnant_rms": 0.05}
    path = {"kind": "lane-change", "start": 5.0}
    changes = [{"seed": k} for k in range(3)]
    assert_as_alone(several(changes, speed=5.0, rider=rider, path=path), exactly=False)


def test_an_interrupted_batch_gives_what_it_had():
    asked = iter(range(10_000))
    outcomes = ride_batch(several([{}, {"seed": 2}]), lambda: next(asked) == 499)
    assert [outcome.ending for outcome in outcomes] == [Ending("interrupted")] * 2
    assert [outcome.history.ticks for outcome in outcomes] == [500, 500]


def test_the_history_of_a_batch_is_that_of_the_record(ridden):
    (outcome,) = ride_batch([Scenario(duration=2.0, seed=3)])
    recorded = History.of_run(ridden(duration=2.0, seed=3))
    assert (outcome.history.ticks, outcome.history.period) == (recorded.ticks, recorded.period)
    np.testing.assert_array_equal(outcome.history.roll, recorded.roll)
    np.testing.assert_array_equal(outcome.history.rider_torque, recorded.rider_torque)


class TestKey:
    def test_figures_of_riders_seeds_and_starts_share_a_batch(self):
        same = several(
            [
                {},
                {"seed": 9},
                {"start": {"roll_deg": 3.0}},
                {"rider": {"name": "human", "visual_delay": 0.1}},
                {"speed": 5.0},
                {"pushes": ({"time": 1.0, "impulse": 5.0},)},
            ]
        )
        assert len({batch_key(one) for one in same}) == 1

    def test_other_things_do_not(self):
        other = several(
            [
                {},
                {"law": "off"},
                {"rig": "phobos"},
                {"rider": "pd"},
                {"period": 0.005},
                {"bicycle": "browser"},
                {"guard": {"torque_limit": 3.0}},
            ]
        )
        assert len({batch_key(one) for one in other}) == len(other)
