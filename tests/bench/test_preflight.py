"""What is judged of a ride before anything is sent: the loop with the haptic cue in it."""

import math
from typing import Any

import pytest

from bikesim.bench.drives import make_drive
from bikesim.bench.preflight import Preflight, check_margins, preflight, told
from bikesim.bench.scenario import bench_scenario
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario

from .lockstep import CIA402, ODRIVE, profile


def ready(bar: dict | None = None, *, wheel: bool = False, **scenario: Any) -> Preflight:
    more = {"wheel": {"radius": 0.34}, "limits": {"speed": 7.0}} if wheel else {}
    bench = profile(bar={"inertia": 0.2311, "delay": 0.002, **(bar or {})}, **more)
    return preflight(bench, bench_scenario(bench, Scenario(**scenario)), make_drive(bench.drive))


@pytest.mark.parametrize(
    "haptics",
    [
        {},
        {"scale": 0.0},
        {"scale": 0.5, "switches": [(1.0, 1.0), (2.0, 0.0)]},
        {"delay": 0.01},
        {"filter_cutoff": 500.0},
        {"delay": 0.02, "scale": 0.2},
        {"limit": 1.0},
    ],
    ids=str,
)
def test_a_cue_with_margin(haptics: dict):
    check_margins(ready(speed=5.0, haptics=haptics), told=0)


@pytest.mark.parametrize(
    ("haptics", "why"),
    [
        ({"delay": 0.045}, "no margin at 5 m/s with 0.2311 kg m² and 47 ms of delay"),
        ({"delay": 0.1}, "102 ms of delay, that of haptics included: at most 50 ms is judged"),
        ({"delay": 2.0}, "2002 ms of delay"),
        ({"filter_cutoff": 30.0, "filter_order": 4}, "2 ms of delay, haptics as in the scenario"),
        ({"scale": 0.0, "delay": 0.045, "switches": [(9.0, 1.0)]}, "no margin at 5 m/s"),
        ({"scale": -1.0}, "a scale of -1 reverses the torque"),
        ({"scale": 3.0}, "a scale of 3 gives more torque than the law"),
        ({"switches": [(5.0, -0.1)]}, "a scale of -0.1 reverses the torque"),
    ],
    ids=str,
)
def test_a_cue_without_is_to_be_wanted_twice(haptics: dict, why: str):
    found = ready(speed=5.0, haptics=haptics)
    for times in (0, 1):
        with pytest.raises(InputError) as error:
            check_margins(found, told=times)
        assert why in str(error.value)
        assert "--without-margin, given twice" in str(error.value)
    check_margins(found, told=2)
    (margin,) = (one for one in told(found) if one.startswith("margin"))
    assert why in margin


def test_a_cue_that_the_period_cannot_carry_is_told_before_the_bus():
    with pytest.raises(InputError, match=r"haptics\.delay = 0\.0001 s"):
        ready(haptics={"delay": 1e-4})


def test_with_a_speed_sensor_every_speed_counts():
    """This bar has margin at 3.5, 5 and 7 m/s, and at 3 m/s and below it has none."""
    light = {"inertia": 0.0427, "delay": 0.010, "coupling": 0.95}
    for speed in (3.5, 5.0, 7.0):
        check_margins(ready(light, speed=speed), told=0)
    with pytest.raises(InputError, match="no margin at 3 m/s"):
        check_margins(ready(light, wheel=True), told=0)
    with pytest.raises(InputError, match="no margin at 3 m/s"):
        check_margins(ready(light, speed_profile=[(0.0, 7.0), (5.0, 1.0)]), told=0)
    standing = ready(wheel=True)
    check_margins(standing, told=0)
    assert min(one.speed for one in standing.margins) == 0.0


def line(found: Preflight, begin: str) -> str:
    (one,) = (one for one in told(found) if one.startswith(begin))
    return one


def test_weaker_thresholds_are_one_line():
    assert not any(one.startswith("weaker") for one in told(ready()))
    bench = profile(thresholds={"zero_age": 0.06, "drive_age": 0.06})
    scenario = bench_scenario(bench, Scenario())
    assert line(preflight(bench, scenario, make_drive(bench.drive)), "weaker") == (
        "weaker   zero_age 60 ms (20), drive_age 60 ms (5); a real bench keeps the defaults"
    )


@pytest.mark.parametrize(
    ("drive", "watchdog"), [(CIA402, "heartbeat_timeout"), (ODRIVE, "watchdog_timeout")]
)
def test_what_the_drive_keeps_to_by_itself(drive: dict, watchdog: str):
    bench = profile({**drive, "torque_limit": 3.58, "speed_limit": 7.0, watchdog: 0.04})
    found = preflight(bench, bench_scenario(bench, Scenario()), make_drive(bench.drive))
    assert line(found, "drive") == (
        "drive    told to keep to 3.58 N m and 7 rad/s at the bar; disables itself when the host "
        "is silent for 40 ms"
    )


def test_what_is_not_watched_without_a_sensor_node():
    assert not any(one.startswith("NOT") for one in told(ready()))
    said = line(ready({"source": "drive"}), "NOT")
    assert "rows 2 to 6 and 21 of the faults" in said
    assert "without a second sensor; the host does not see the emergency stop" in said


@pytest.mark.parametrize(
    ("lag", "takes"),
    [
        # A slow motion sees each as a delay: order 2 of a low pass √2/ω, a lag itself, a sensor
        # every n periods (n - 1)/2 of them.
        ({"filter_cutoff": 400.0}, math.sqrt(2) / 400),
        ({"filter_cutoff": 400.0, "filter_order": 1}, 1 / 400),
        ({"drive_lag": 0.004}, 0.004),
        ({"sensor_interval": 0.005}, 0.002),
    ],
    ids=str,
)
def test_what_the_bar_knows_late_costs_margin(lag: dict, takes: float):
    bar = {"inertia": 0.2311, "delay": 0.002}
    without, found = ready(bar, speed=5.0).worst, ready(bar | lag, speed=5.0).worst
    assert without.delay_margin - found.delay_margin == pytest.approx(takes, rel=0.35)


def test_two_filters_at_once_are_to_be_wanted_twice():
    bar = {"inertia": 0.2311, "delay": 0.002, "filter_cutoff": 400.0}
    found = ready(bar, speed=5.0, haptics={"filter_cutoff": 300.0})
    with pytest.raises(InputError, match="two filters at once are not judged"):
        check_margins(found, told=0)
    check_margins(found, told=2)
