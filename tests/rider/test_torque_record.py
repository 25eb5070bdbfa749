"""The torque of a recorded run that did not measure it: a person's on a bench, another rig's."""

import math
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.experiment.run import build, ride_parts, run
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.torque_record import with_recorded_torque
from bikesim.record.reader import open_run
from bikesim.record.recording import read_recording
from bikesim.rider.settings import RiderSettings


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A rider with arms, on a bicycle that balances itself."""
    path = tmp_path / "person.h5"
    person = RiderSettings(name="human", remnant_rms=0.3)
    run(build(Scenario(speed=5.0, duration=5, seed=3, rider=person)), path)
    return path


@pytest.fixture
def unmeasured(recorded: Path) -> Path:
    """The same, as a bench records it: without the rider's torque."""
    with h5py.File(recorded, "r+") as file:
        del file["channels/rider_torque"]
    return recorded


def played(file: Path, **given: Any) -> RiderSettings:
    script = {"kind": "record", "file": str(file), **given}
    return RiderSettings(name="torque-record", script=script)  # type: ignore[arg-type]


def test_a_record_without_the_torque_gives_that_of_the_bar_and_so_the_same_ride(unmeasured: Path):
    """Arms are in it, so the rider who plays it has none; the steer agrees within 3 %."""
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    ride_parts(build(Scenario(speed=5.0, duration=5, rider=played(unmeasured))), Rows())
    steer = open_run(unmeasured).channel("steer")
    assert np.abs(steer).max() > math.radians(0.3)
    assert np.std(np.array(rows)[:, 1] - steer) < 0.03 * np.std(steer)


def test_the_inertia_replaces_that_of_the_record(unmeasured: Path):
    samples = []
    for inertia in (0.1, 0.2, 0.3):
        script = with_recorded_torque(played(unmeasured, inertia=inertia)).script
        assert script is not None
        samples.append(np.array(script.samples)[:, 1])
    assert samples[2] - samples[1] == pytest.approx(samples[1] - samples[0], abs=1e-12)
    assert np.ptp(samples[1] - samples[0]) > 0


def test_an_inertia_beside_a_torque_that_was_recorded_is_refused(recorded: Path):
    with pytest.raises(InputError, match=r"has the channel rider_torque: .*inertia is of no use"):
        with_recorded_torque(played(recorded, inertia=0.2))


def test_the_recording_of_another_rig_is_played(shared: Path):
    path = shared / "recordings" / "phobos_5mps.csv.gz"
    with pytest.raises(InputError, match=r"script\.file .*gz: a CSV .* rider\.script\.inertia"):
        with_recorded_torque(played(path))
    script = with_recorded_torque(played(path, inertia=0.0427)).script
    assert script is not None
    time, torque = np.array(script.samples).T
    held = read_recording(path).torque
    assert (time[0], time[-1]) == (0.0, pytest.approx(0.001 * (len(held) - 1), abs=1e-6))
    # At 5 m/s the person mostly holds against the motor.
    assert np.std(torque) == pytest.approx(np.std(held), rel=0.05)


def test_an_inertia_is_of_a_record_only():
    with pytest.raises(InputError, match=r"rider\.script\.inertia = 0\.2: kind step has no such"):
        RiderSettings(name="torque-step", script={"kind": "step", "inertia": 0.2})  # type: ignore[arg-type]
