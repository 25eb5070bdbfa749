"""What a profile may not say: thresholds in the wrong unit, torque past the nameplate, identifiers
of others."""

import pytest

from bikesim.bench.faults import Thresholds, weaker
from bikesim.bench.profile import bench_names, load_bench
from bikesim.errors import InputError

from .lockstep import CIA402, ODRIVE, profile

FROM_DRIVE = {"inertia": 0.2311, "source": "drive"}


@pytest.mark.parametrize(
    ("key", "figure", "allowed"),
    [
        ("hold_age", 3.0, "above 0 and at most 0.5"),
        ("ramp_age", 10.0, "above 0 and at most 0.5"),
        ("zero_age", 20.0, "above 0 and at most 0.5"),
        ("drive_age", 5.0, "above 0 and at most 0.5"),
        ("slip_time", 20.0, "above 0 and at most 0.5"),
        ("follow_time", 20.0, "above 0 and at most 0.5"),
        ("trip_rate_time", 2.0, "above 0 and at most 0.1"),
        ("late", 1.0, "above 0 and at most 0.2"),
        ("late_most", 20.0, "above 0 and at most 0.2"),
        ("ramp_out", 100.0, "above 0 and at most 0.5"),
        ("wheel_silent", 500.0, "above 0 and at most 5"),
        ("saturated_time", 500.0, "above 0 and at most 5"),
        ("thermal_time", 10_000.0, "above 0 and at most 60"),
        ("cooled_time", 5000.0, "above 0 and at most 30"),
        ("bias_time", 2000.0, "at least 0.2 and at most 20"),
        ("bias_time", 0.002, "at least 0.2 and at most 20"),
        ("ramp_in", 1e-6, "at least 0.01 and at most 60"),
    ],
)
def test_a_time_in_milliseconds_or_none_at_all_is_refused(key: str, figure: float, allowed: str):
    with pytest.raises(InputError, match=rf"thresholds\.{key} = .*: must be {allowed}$"):
        profile(thresholds={key: figure})


@pytest.mark.parametrize(
    ("key", "figure", "allowed"),
    [
        ("fall_roll_deg", 90.0, "above 0 and below 90"),
        ("trip_rate", 458.0, "above 0 and at most 20"),
        ("slip_rate", 28.6, "above 0 and at most 5"),
        ("angle_step", 1.15, "above 0 and at most 0.2"),
        ("bias_angle", 2.86, "above 0 and at most 0.5"),
        ("follow_error", 10.0, "above 0 and at most 5"),
        ("drive_heartbeats", 150.0, "at least 1 and at most 20"),
        ("drive_heartbeats", 0.1, "at least 1 and at most 20"),
        ("bad_frames", 1000, "at least 1 and at most 100"),
        ("frozen_frames", 1000, "at least 1 and at most 100"),
        ("late_ticks", 100_000, "at least 1 and at most 1000"),
        ("slewed_ticks", 100_000, "at least 1 and at most 1000"),
        ("skipped_share", 1.0, "above 0 and below 1"),
        ("trip_angle_deg", 1000.0, "above 0 and at most 180"),
    ],
)
def test_a_figure_that_no_bar_reaches_is_refused(key: str, figure: float, allowed: str):
    with pytest.raises(InputError, match=rf"thresholds\.{key} = .*: must be {allowed}$"):
        profile(thresholds={key: figure})


def test_the_defaults_are_the_weakest_that_nobody_is_told_of():
    assert weaker(Thresholds()) == []
    stricter = {"hold_age": 0.002, "trip_rate": 4.0, "bad_frames": 1, "ramp_in": 2.0,
                "bias_time": 4.0}  # fmt: skip
    assert weaker(Thresholds(**stricter)) == []


def test_weaker_ones_with_value_and_default():
    given = {"zero_age": 0.06, "bias_time": 1.0, "trip_angle_deg": 50.0, "trip_rate": 10.0,
             "late_ticks": 40, "ramp_in": 0.5, "follow_error": 1.0, "cooled_time": 7.0}  # fmt: skip
    assert weaker(Thresholds(**given)) == [
        "zero_age 60 ms (20)", "bias_time 1 s (2)", "trip_angle_deg 50 (45)",
        "trip_rate 10 rad/s (8)", "cooled_time 7 s (5)", "follow_error 1 N m (0.5)",
        "late_ticks 40 (20)", "ramp_in 0.5 s (1)",
    ]  # fmt: skip


def test_only_the_emulated_ones_that_ship_have_weaker_ones():
    assert {name for name in bench_names() if weaker(load_bench(name).thresholds)} == {
        "cia402-emulated", "odrive-emulated",
    }  # fmt: skip


def test_no_more_for_ever_than_the_nameplate_says():
    """0.386 N m at the shaft, gear 5.5: 2.123 N m at the steer axis."""
    profile(limits={"continuous_torque": 2.123})
    with pytest.raises(
        InputError,
        match=r"limits\.continuous_torque = 2\.13 N m: is more than the nameplate's, "
        r"drive\.rated_torque × drive\.gear = 2\.123 N m",
    ):
        profile(limits={"continuous_torque": 2.13})
    with pytest.raises(InputError, match=r"continuous_torque = 2\.0 N m: .* = 1\.93 N m"):
        profile({**CIA402, "gear": 5.0})
    profile(ODRIVE, limits={"continuous_torque": 3.0})


@pytest.mark.parametrize("node", [8, 9])
def test_an_odrive_with_the_sensors_identifiers(node: int):
    odrive = {**ODRIVE, "node": node, "estimates_period": 0.001}
    refused = pytest.raises(
        InputError, match=rf"drive\.node = {node}: has identifiers of the sensor nodes"
    )
    with refused:
        profile(odrive)
    with refused:
        profile(odrive, bar=FROM_DRIVE, wheel={"radius": 0.34})
    profile(odrive, bar=FROM_DRIVE)
    for other in (7, 10):
        profile({**odrive, "node": other})
