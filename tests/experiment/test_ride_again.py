from dataclasses import replace

import h5py
import pytest

from bikesim.errors import InputError
from bikesim.experiment.ride_again import ride_again
from bikesim.record.reader import open_run

RIDE = {
    "speed_profile": [[0, 3.2], [0.3, 4]],
    "pushes": [{"time": 0.1, "impulse": 3}],
    "start": {"roll_deg": 2, "heading_deg": 10},
    "guard": {"torque_limit": 1, "torque_rate_limit": 50},
}


@pytest.mark.parametrize("law", ["paper", "momentum", "off"])
@pytest.mark.parametrize("rig", ["ideal", "delft2013", "phobos"])
def test_gives_the_torques_again_to_the_last_bit(ridden, law: str, rig: str):
    assert ride_again(ridden(law=law, rig=rig, **RIDE)) == (300, 0, 0)


def test_a_fall_too(ridden):
    run = ridden(rider="hands-off", start={"roll_deg": 30}, duration=5)
    assert ride_again(run) == (run.ticks, 0, 0)


def test_another_bicycle_is_found_out(ridden):
    run = ridden(start={"roll_deg": 2})
    other = replace(run, bicycle=run.bicycle.with_gravity(9.7))
    assert ride_again(other).feedback_torque > 1e-3


@pytest.mark.parametrize(
    ("scenario", "what"),
    [
        ("rig = ", "not TOML"),
        ("a = 1", "'rig' is missing"),
        ("rig = 3", ""),
        ('[rig]\nsteer_stop_deg = "wide"', ""),
        ("[rig]\nsteer_stop_deg = 60", "'guard' is missing"),
        ("guard = 3\n[rig]\nsteer_stop_deg = 60", ""),
        ("[rig]\nsteer_stop_deg = 60\n[guard]\ntorque_limit = -1", "guard.torque_limit = -1"),
    ],
)
def test_a_scenario_that_is_damaged_is_told_with_its_record(ridden, scenario: str, what: str):
    run = replace(ridden(), scenario=scenario)
    with pytest.raises(InputError) as refused:
        ride_again(run)
    assert str(refused.value).startswith(f"{run.path}: its scenario is damaged: {what}")


def test_a_torque_that_was_changed_is_found_out(ridden):
    run = ridden()
    with h5py.File(run.path, "r+") as file:
        file["channels/allowed_torque"][100] += 1e-12  # pyright: ignore
    ticks, feedback_torque, allowed_torque = ride_again(open_run(run.path))
    assert (ticks, feedback_torque) == (300, 0)
    assert allowed_torque == pytest.approx(1e-12, rel=1e-3)
