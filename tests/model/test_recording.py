"""Our law against a real haptic bicycle: phobos, TU Delft 2017, 33 s at 1 kHz (SCIENCE, Sec. 6)."""

from pathlib import Path

import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.record.recording import read_recording
from bikesim.record.replay import Comparison, compare

GRAVITY, TORQUE_LIMIT = 9.80665, 10.78125


@pytest.fixture(scope="module")
def comparison(shared: Path, benchmark: Bicycle) -> Comparison:
    recording = read_recording(shared / "recordings" / "phobos_5mps.csv.gz")
    return compare(recording, benchmark.with_gravity(GRAVITY), torque_limit=TORQUE_LIMIT)


def test_all_ticks_until_the_fall_are_compared(comparison: Comparison):
    assert comparison.compared_rows == pytest.approx(31_900, abs=50)


def test_the_torque_is_within_one_bit_of_its_converter(comparison: Comparison):
    assert comparison.max_torque_error <= 0.0053


def test_the_roll_of_one_step_is_within_its_float32(comparison: Comparison):
    """That rig kept the roll in single precision and wrote seven digits: two of the last bits.

    All but a thousandth of the ticks are within 1.0e-7 rad.
    """
    assert comparison.max_one_step_roll_error <= 1.5e-7


def test_the_roll_rate_of_one_step(comparison: Comparison):
    assert comparison.max_one_step_roll_rate_error <= 6.1e-5
