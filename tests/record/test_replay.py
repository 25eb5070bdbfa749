"""Our law against the recording of a real rig, and against records of our own."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.record.recording import Recording, read_recording
from bikesim.record.replay import compare

LIMIT = 10.78125  # of that rig's converter [N m]


@pytest.fixture(scope="module")
def real(shared: Path) -> Recording:
    return read_recording(shared / "recordings/phobos_5mps.csv.gz")


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    """Under the gravity of that rig's program."""
    return bicycles.load("benchmark").with_gravity(9.80665)


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("ours") / "run.h5"
    keys = {
        "duration": 0.5, "rig": "delft2013", "start": {"roll_deg": 3},
        "pushes": [{"time": 0.1, "impulse": 3}], "speed_profile": [[0, 3], [0.4, 4]],
    }  # fmt: skip
    run(build(Scenario(**keys)), path)
    return read_recording(path)


class TestRealRecording:
    def test_its_rows(self, real: Recording):
        assert len(real.time) == 33_182
        assert real.time[[0, -1]] == pytest.approx([0, 33.181], abs=0.01)
        assert np.all(real.speed == 5)
        assert (real.bicycle, real.law, real.run) == (None, None, None)

    def test_torque_within_a_bit_of_the_converter(self, real: Recording, benchmark: Bicycle):
        found = compare(real, benchmark, torque_limit=LIMIT)
        assert found.max_torque_error <= 0.0053
        assert 0 < found.rms_torque_error < 0.0053

    def test_roll_over_one_step(self, real: Recording, benchmark: Bicycle):
        """SCIENCE: 1e-7 rad and 6.1e-5 rad/s with that rig's own rounding."""
        found = compare(real, benchmark, torque_limit=LIMIT)
        assert found.max_one_step_roll_error < 1.5e-7
        assert found.max_one_step_roll_rate_error <= 6.1e-5

    def test_until_the_fall_and_no_farther(self, real: Recording, benchmark: Bicycle):
        found = compare(real, benchmark, torque_limit=LIMIT)
        assert real.time[found.compared_rows] == pytest.approx(31.9, abs=0.05)
        assert np.all(np.abs(real.roll[: found.compared_rows]) <= np.pi / 4)
        assert abs(real.roll[found.compared_rows]) > np.pi / 4

    def test_the_limit_matters(self, real: Recording, benchmark: Bicycle):
        """Somewhere that rig wanted more than its converter could give."""
        assert np.abs(real.torque).max() == pytest.approx(LIMIT, abs=0.01)
        assert compare(real, benchmark).max_torque_error > 0.0053

    def test_the_sample_that_it_held_matters(self, real: Recording, benchmark: Bicycle):
        interpolated = compare(replace(real, held=False), benchmark, torque_limit=LIMIT)
        assert interpolated.max_one_step_roll_error > 1.5e-7

    def test_the_torque_is_that_of_the_equation(self, real: Recording, benchmark: Bicycle):
        """Eq. 4 and 6 written out, at each row."""
        m, v, g = benchmark.matrices, 5.0, benchmark.gravity
        C, K = v * m.C1, g * m.K0 + v**2 * m.K2
        rows = slice(0, compare(real, benchmark).compared_rows)
        phi, phi_dot = real.roll[rows], real.roll_rate[rows]
        delta, delta_dot = real.steer[rows], real.steer_rate[rows]
        phi_ddot = (
            -(C[0, 0] * phi_dot + C[0, 1] * delta_dot + K[0, 0] * phi + K[0, 1] * delta) / m.M[0, 0]
        )
        T_f = -(
            m.M[1, 0] * phi_ddot + C[1, 0] * phi_dot + C[1, 1] * delta_dot
            + K[1, 0] * phi + K[1, 1] * delta
        )  # fmt: skip
        error = np.abs(np.clip(T_f, -LIMIT, LIMIT) - real.torque[rows]).max()
        found = compare(real, benchmark, torque_limit=LIMIT).max_torque_error
        assert error == pytest.approx(found, abs=1e-12)


class TestOurRecord:
    def test_knows_its_bicycle_and_law(self, ours: Recording):
        assert ours.bicycle is not None
        assert (ours.bicycle.name, ours.law, ours.held) == ("benchmark", "paper", False)

    def test_gives_the_same_torques_to_the_last_bit(self, ours: Recording):
        assert ours.bicycle is not None
        found = compare(ours, ours.bicycle)
        assert (found.rows, found.compared_rows) == (500, 500)
        assert (found.max_torque_error, found.rms_torque_error) == (0, 0)

    def test_gives_the_same_steps_to_the_last_bit(self, ours: Recording):
        assert ours.bicycle is not None
        found = compare(ours, ours.bicycle)
        assert found.max_one_step_roll_error == found.max_one_step_roll_rate_error == 0

    @pytest.mark.parametrize("part", ["roll_moment", "speed"])
    def test_its_pushes_and_its_speed_count(self, ours: Recording, part: str):
        assert ours.bicycle is not None
        other: dict[str, Any] = {part: np.full_like(ours.time, 3.0)}
        without = replace(ours, **other)
        assert compare(without, ours.bicycle).max_torque_error > 1e-3

    @pytest.mark.parametrize("law", ["momentum", "off"])
    def test_another_law(self, ours: Recording, law: str):
        assert ours.bicycle is not None
        found = compare(ours, ours.bicycle, law=law)
        assert found.law == law
        assert max(found.max_torque_error, found.max_one_step_roll_rate_error) > 1e-6


def still(**columns: Any) -> Recording:
    """A recording of five rows at rest, with these columns."""
    names = "time speed roll roll_rate steer steer_rate torque roll_moment steer_moment".split()
    values: dict[str, Any] = {name: np.zeros(5) for name in names}
    values["time"] = 0.01 * np.arange(5)
    return Recording(path=Path("still.csv"), held=False, **(values | columns))


def test_nothing_moves_and_nothing_is_wrong(benchmark: Bicycle):
    found = compare(still(), benchmark)
    assert (found.compared_rows, found.max_torque_error, found.max_one_step_roll_error) == (5, 0, 0)


def test_an_error_is_told_by_its_largest_and_its_root_mean_square(benchmark: Bicycle):
    found = compare(still(torque=np.array([0, 3, 0, -4, 0.0])), benchmark)
    assert found.max_torque_error == 4
    assert found.rms_torque_error == pytest.approx(5**0.5)


def test_a_fall_at_once_leaves_nothing_to_compare(benchmark: Bicycle):
    with pytest.raises(InputError, match=r"still\.csv: rows before the fall: 0; at least 2"):
        compare(still(roll=np.full(5, 0.8)), benchmark)


def test_an_unknown_law(benchmark: Bicycle):
    with pytest.raises(InputError, match="must be one of paper, momentum, off"):
        compare(still(), benchmark, law="papr")


def test_a_record_without_ticks(record):
    with record(10) as writer:
        pass
    with pytest.raises(InputError, match="no ticks are recorded"):
        read_recording(writer.path)
