import math

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from bikesim.rig.virtual import VirtualRig

from .conftest import MakeRig, true_rate, true_steer, turn, wait


def read(rig: VirtualRig, ticks: int) -> np.ndarray:
    """Measured angle and rate, true angle and rate at each tick, shape (ticks, 4)."""
    rows = []
    for _ in range(ticks):
        sample = rig.read()
        rows.append((sample.steer, sample.steer_rate, true_steer(rig), true_rate(rig)))
        rig.wait()
    return np.array(rows)


def test_an_ideal_sensor_says_the_truth(make_rig: MakeRig):
    rig = make_rig()
    rig.command(0.5)
    rows = read(rig, 300)
    assert rows[:, :2] == pytest.approx(rows[:, 2:], rel=1e-12, abs=1e-15)


def test_a_bias_is_added(make_rig: MakeRig):
    rig = make_rig(angle_bias=0.01, rate_bias=-0.02)
    turn(rig, rate=0.5)
    rows = read(rig, 100)[1:]
    assert rows[:, 0] - rows[:, 2] == pytest.approx(0.01)
    assert rows[:, 1] - rows[:, 3] == pytest.approx(-0.02)


def test_counts_are_whole_and_the_nearest(make_rig: MakeRig):
    rig = make_rig(angle_resolution=2.77e-3, rate_resolution=4.26e-3)
    rig.command(0.3)
    rows = read(rig, 300)
    for measured, true, count in (
        (rows[:, 0], rows[:, 2], 2.77e-3),
        (rows[:, 1], rows[:, 3], 4.26e-3),
    ):
        assert measured / count == pytest.approx(np.round(measured / count), abs=1e-9)
        assert np.abs(measured - true).max() <= count / 2 + 1e-12


def test_noise_is_white_and_as_strong_as_asked(make_rig: MakeRig):
    rows = read(make_rig(angle_noise=1e-3, rate_noise=0.02), 4000)
    angle, rate = rows[:, 0] - rows[:, 2], rows[:, 1] - rows[:, 3]
    assert angle.std() == pytest.approx(1e-3, rel=0.05)
    assert rate.std() == pytest.approx(0.02, rel=0.05)
    assert abs(angle.mean()) < 4e-3 / math.sqrt(4000)
    for one, other in ((angle[1:], angle[:-1]), (rate[1:], rate[:-1]), (angle, rate)):
        assert abs(np.corrcoef(one, other)[0, 1]) < 0.06


def test_noise_is_its_seeds(make_rig: MakeRig):
    first, again, other = (
        read(make_rig(angle_noise=1e-3, seed=seed), 50)[:, 0].tolist() for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other


@pytest.mark.parametrize("milliseconds", [1.0, 2.5, 9.0])
@pytest.mark.parametrize("step", [1e-4, 5e-4])
def test_a_delay_is_as_many_milliseconds(make_rig: MakeRig, milliseconds: float, step: float):
    rig = make_rig(sensor_delay=milliseconds * 1e-3, step=step)
    turn(rig, rate=1.0)
    rows = read(rig, 60)[30:]
    assert rows[:, 2] - rows[:, 0] == pytest.approx(milliseconds * 1e-3, abs=1e-9)


def test_a_delay_is_the_same_for_angle_and_rate(make_rig: MakeRig):
    rig = make_rig(sensor_delay=4e-3)
    rig.command(0.5)
    rows = read(rig, 100)
    assert rows[4:, :2] == pytest.approx(rows[:-4, 2:], abs=1e-12)


def test_between_conversions_the_value_is_held(make_rig: MakeRig):
    rig = make_rig(sensor_interval=0.02)
    turn(rig, rate=1.0)
    angle = read(rig, 200)[40:, 0]
    steps = np.diff(angle)
    assert np.flatnonzero(steps) % 20 == pytest.approx(np.flatnonzero(steps)[0] % 20)
    assert steps[steps != 0] == pytest.approx(0.02)


def test_the_age_of_a_value_is_between_delay_and_delay_with_interval(make_rig: MakeRig):
    rig = make_rig(sensor_interval=0.02, sensor_delay=2.5e-3)
    turn(rig, rate=1.0)
    rows = read(rig, 300)[50:]
    age = rows[:, 2] - rows[:, 0]
    assert age.min() >= 2.5e-3 - 1e-9
    assert age.max() <= 22.5e-3 + 1e-9


def test_a_conversion_has_one_noise_while_it_is_held(make_rig: MakeRig):
    rig = make_rig(sensor_interval=0.02, angle_noise=1e-3)
    turn(rig, rate=1.0)
    angle = read(rig, 400)[:, 0]
    assert len(set(angle)) == pytest.approx(400 / 20, abs=1)


class TestFilter:
    def test_treats_angle_and_rate_alike(self, make_rig: MakeRig):
        """So the filtered rate is the rate of the filtered angle."""
        rig = make_rig(filter_cutoff=50.0)
        rig.command(0.5)
        rows = read(rig, 400)
        mean_rate = (rows[1:, 1] + rows[:-1, 1]) / 2
        assert np.diff(rows[:, 0]) / 1e-3 == pytest.approx(mean_rate, abs=2e-3)
        assert (rows[200:, 3] - rows[200:, 1]).min() > 0.01

    def test_of_the_rig_is_scipys_on_what_it_measures(self, make_rig: MakeRig):
        plain, filtered = (
            make_rig(angle_noise=1e-3, rate_noise=1e-2, filter_cutoff=cutoff)
            for cutoff in (None, 80.0)
        )
        raw, ours = read(plain, 300), read(filtered, 300)
        sections = butter(2, 80.0 / (2 * math.pi), fs=1000.0, output="sos")
        for column in (0, 1):
            # After a second the start is forgotten.
            theirs = sosfilt(sections, raw[:, column])
            assert ours[250:, column] == pytest.approx(theirs[250:], abs=1e-7)

    def test_takes_the_noise_away(self, make_rig: MakeRig):
        plain, filtered = (
            read(make_rig(rate_noise=0.02, filter_cutoff=cutoff), 3000)[:, 1]
            for cutoff in (None, 60.0)
        )
        assert filtered.std() < 0.3 * plain.std()


def test_waiting_without_reading_changes_no_bar(make_rig: MakeRig):
    read_often, read_once = make_rig(angle_noise=1e-3), make_rig(angle_noise=1e-3)
    for rig in (read_often, read_once):
        rig.command(0.3)
    read(read_often, 100)
    wait(read_once, 100)
    assert true_steer(read_often) == true_steer(read_once)
