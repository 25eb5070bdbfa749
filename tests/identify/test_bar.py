"""The torque of a rider by the motion of the bar, against what was recorded or what is true."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.signal import savgol_filter

from bikesim.errors import InputError
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.identify.bar import read_bar_torque
from bikesim.record.reader import open_run
from bikesim.record.recording import read_recording
from bikesim.rider.settings import RiderSettings

COLUMNS = "time_s,speed_m_s,roll_rad,roll_rate_rad_s,steer_rad,steer_rate_rad_s,torque_command_Nm"
BLOCK = 0.02


def mean_over_blocks(time: np.ndarray, values: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """By the trapezium between values interpolated on a grid ten times as fine as the ticks."""
    offset = np.linspace(-BLOCK / 2, BLOCK / 2, 101)
    return trapezoid(np.interp(middle[:, None] + offset, time, values), dx=1 / 100, axis=1)


@pytest.mark.parametrize("rider", ["schwab2013-184", "human"], ids=["no arms", "arms"])
def test_it_is_the_torque_that_a_virtual_rig_recorded_and_that_of_the_arms(
    tmp_path: Path, rider: str
):
    """Within 2 % of its standard deviation."""
    settings = RiderSettings(name=rider, remnant_rms=0.3)
    scenario = Scenario(bicycle="davis", speed=3.19, duration=10, rider=settings, seed=3)
    run(build(scenario), tmp_path / "ride.h5")
    record = open_run(tmp_path / "ride.h5")
    found = read_bar_torque(tmp_path / "ride.h5")
    rate, arms = record.channel("true_steer_rate"), scenario.rider
    given = (
        record.channel("rider_torque")
        - (arms.arm_inertia or 0.0) * np.gradient(rate, record.period)
        - (arms.arm_damping or 0.0) * rate
        - (arms.arm_stiffness or 0.0) * record.channel("true_steer")
    )
    middle = found.time[1:-1]
    expected = mean_over_blocks(record.time - scenario.physics_step, given, middle)
    assert np.std(given) > 0.2
    assert np.std((found.torque[1:-1] - expected)[5:-5]) < 0.02 * np.std(given)


def test_the_recording_of_another_rig(shared: Path):
    """Against the slope of a line through 21 ticks, within 2 %."""
    path = shared / "recordings" / "phobos_5mps.csv.gz"
    found, recording = read_bar_torque(path, 0.0427), read_recording(path)
    time = recording.time - recording.time[0]
    acceleration = savgol_filter(recording.steer_rate, 21, 1, deriv=1, delta=0.001)
    expected = 0.0427 * acceleration - np.convolve(recording.torque, np.ones(20) / 20, "same")
    off = found.torque - np.interp(found.time, time, expected)
    assert (found.time[0], found.time[-1]) == (0.0, pytest.approx(time[-1]))
    assert np.std(expected) > 1
    assert np.std(off[2:-2]) < 0.02 * np.std(expected)


def csv(path: Path, time: np.ndarray, **columns: np.ndarray) -> Path:
    values = [columns.get(name, 0 * time) for name in COLUMNS.split(",")[1:]]
    np.savetxt(path, np.column_stack([time, *values]), delimiter=",", header=COLUMNS, comments="")
    return path


def test_its_sign_its_time_and_its_ends(tmp_path: Path):
    """A clock that begins late; a bar that gains speed against a motor that pulls it left."""
    time = 7.0 + 0.005 * np.arange(43)
    path = csv(
        tmp_path / "a.csv", time, steer_rate_rad_s=2 * (time - 7), torque_command_Nm=0 * time - 3
    )
    found = read_bar_torque(path, 0.5)
    assert found.torque == pytest.approx(np.full(12, 0.5 * 2 + 3))
    assert found.time == pytest.approx([0, *(0.01 + 0.02 * np.arange(10)), 0.21])


@pytest.mark.parametrize(
    ("ticks", "inertia", "message"),
    [(100, None, "handlebar's inertia; give one"), (1, 0.2, "too few"), (3, 0.2, "too few")],
)
def test_a_recording_that_does_not_say_it_is_refused(
    tmp_path: Path, ticks: int, inertia: float | None, message: str
):
    path = csv(tmp_path / "a.csv", 0.001 * np.arange(ticks))
    with pytest.raises(InputError, match=message):
        read_bar_torque(path, inertia)
