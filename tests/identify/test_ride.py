"""What is read from records and recordings, and what is refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.identify.ride import Passive, Ride, check_together, read_ride
from bikesim.model.law import Law


@pytest.fixture(scope="module")
def ridden(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ridden") / "run.h5"
    disturbance = Disturbance(kind="roll-multisine", torque_rms=2.0)
    run(build(Scenario(duration=3, disturbances=(disturbance,))), path)
    return path


@pytest.fixture
def record(ridden: Path, tmp_path: Path) -> Path:
    copy = tmp_path / "run.h5"
    copy.write_bytes(ridden.read_bytes())
    return copy


def test_a_record_of_ours(record: Path):
    ride = read_ride(record)
    assert (ride.bicycle.name, ride.law, ride.rider) == ("benchmark", Law.PAPER, "human")
    assert (ride.speed, ride.speed_range, ride.fell) == (3.5, 0.0, None)
    assert ride.duration == pytest.approx(3)
    assert ride.disturbed
    assert ride.straight
    assert (ride.passive.inertia, ride.passive.damping, ride.passive.stiffness) == (0.1, 2.0, 5.0)
    assert ride.rider_torque is not None
    # The bar turned as rider, arms and motor had it: I δ̈ = T_δ + T_f - J δ̈ - b δ̇ - k δ.
    change = np.diff(ride.steer_rate) / ride.period
    pull = (ride.rider_torque + np.roll(ride.motor_torque, 1))[1:]
    held = ride.passive
    resisting = held.damping * ride.steer_rate[1:] + held.stiffness * ride.steer[1:]
    left = (ride.inertia + held.inertia) * change - (pull - resisting)
    assert np.abs(left).max() < 0.05 * np.abs(pull).max()


def test_what_is_given_replaces_what_is_recorded(record: Path):
    davis = bicycles.load("davis")
    ride = read_ride(record, bicycle=davis, inertia=0.5, gravity=9.0, law=Law.OFF)
    assert (ride.bicycle.name, ride.bicycle.gravity) == ("davis", 9.0)
    assert (ride.inertia, ride.law) == (0.5, Law.OFF)


def test_a_record_is_cut_off_a_second_before_the_fall(tmp_path: Path):
    path = tmp_path / "off.h5"
    ending = run(build(Scenario(law="off", duration=10)), path)
    assert ending.fall_time is not None
    ride = read_ride(path)
    assert ride.fell == pytest.approx(ending.fall_time)
    assert ride.duration == pytest.approx(ending.fall_time - 1, abs=0.002)


def test_the_recording_of_another_rig(shared: Path):
    path = shared / "recordings" / "phobos_5mps.csv.gz"
    ride = read_ride(path, bicycle=bicycles.load("benchmark"), inertia=0.0427, gravity=9.80665)
    assert (ride.period, ride.speed, ride.disturbed) == (0.001, 5.0, False)
    assert (ride.rider_torque, ride.heading, ride.passive.stiffness) == (None, None, 0.0)
    assert ride.fell == pytest.approx(31.9, abs=0.05)
    assert np.abs(ride.roll).max() < np.pi / 4
    with pytest.raises(InputError, match=r"whose bicycle it is; give --bicycle"):
        read_ride(path)
    with pytest.raises(InputError, match=r"its handlebar's inertia; give --inertia"):
        read_ride(path, bicycle=bicycles.load("benchmark"))


def test_a_jittering_clock_is_put_on_an_even_one(tmp_path: Path):
    random = np.random.default_rng(1)
    time = np.arange(2000) * 0.01 + 0.002 * random.random(2000)
    columns = np.column_stack([time, np.sin(time), *(0 * time,) * 4, 0 * time + 3])
    names = "time_s,steer_rad,roll_rad,roll_rate_rad_s,steer_rate_rad_s,torque_command_Nm,speed_m_s"
    path = tmp_path / "jitter.csv"
    np.savetxt(path, columns, delimiter=",", header=names, comments="")
    ride = read_ride(path, bicycle=bicycles.load("benchmark"), inertia=0.2)
    even = time[0] + ride.period * np.arange(len(ride.steer))
    assert ride.steer == pytest.approx(np.sin(even), abs=1e-4)
    columns[1000:, 0] += 1.0
    np.savetxt(path, columns, delimiter=",", header=names, comments="")
    with pytest.raises(InputError, match=r"1.01 s without a sample after 9.99\d* s: too long"):
        read_ride(path, bicycle=bicycles.load("benchmark"), inertia=0.2)


def edited(path: Path, edit: Callable[[h5py.File], None]) -> Path:
    with h5py.File(path, "r+") as file:
        edit(file)
    return path


def test_a_channel_that_is_missing(record: Path):
    def remove(file: h5py.File) -> None:
        del file["channels/roll_moment"]

    with pytest.raises(InputError, match=r"run.h5: channel roll_moment is missing; identification"):
        read_ride(edited(record, remove))


def test_a_value_that_is_no_number(record: Path):
    def spoil(file: h5py.File) -> None:
        channels = file["channels"]
        assert isinstance(channels, h5py.Group)
        values = channels["roll_rate"]
        assert isinstance(values, h5py.Dataset)
        values[1234] = np.nan

    with pytest.raises(InputError, match=r"run.h5: roll_rate is nan at 1.234 s: it must be a num"):
        read_ride(edited(record, spoil))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"law": Law.MOMENTUM}, "law momentum, but ride has paper: identify them apart"),
        ({"bicycle": "benchmark"}, "bicycle benchmark, but ride has davis"),
        ({"speed": 3.5}, "ridden at 3.5 m/s, but ride at 3.19 m/s: identify them apart"),
        ({"rider": "185"}, "rider 185, but ride has 184"),
        ({"period": 0.004}, "loop period 0.004 s, but ride has 0.002 s"),
        ({"rider_torque": None}, "rider_torque channel: no, but ride has yes"),
        ({"roll_moment": np.zeros(30000)}, "known disturbance: no, but ride has yes"),
    ],
    ids=str,
)
def test_rides_that_do_not_belong_together(exact: Ride, change: dict, message: str):
    if "bicycle" in change:
        change = {"bicycle": bicycles.load(change["bicycle"])}
    with pytest.raises(InputError, match=f"^other: {message}"):
        check_together([exact, replace(exact, name="other", **change)])
    mirrored = {"roll": -exact.roll, "steer": -exact.steer}
    check_together([exact, replace(exact, name="other", passive=Passive(), **mirrored)])


def test_a_ride_counts_once_whatever_it_is_called(exact: Ride):
    """Whole or its beginning: of equal scenario and seed a shorter ride is part of a longer one."""
    half = len(exact.roll) // 2
    cut = replace(exact, name="cut", roll=exact.roll[:half], steer=exact.steer[:half])
    for again in (replace(exact, name="copy"), cut):
        with pytest.raises(InputError, match=f"^{again.name}: the same ride as {exact.name}"):
            check_together([exact, again])
