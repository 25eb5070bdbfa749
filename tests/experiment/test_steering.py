import numpy as np
import pytest

from bikesim.experiment.steering import reversals, work

TIME = 0.01 * np.arange(1001)


def test_work_of_a_torque_in_phase_with_the_rate():
    """T = 2 sin(t), δ̇ = 3 sin(t): ∫ 6 sin² = 3 (t - sin(2 t) / 2), all of it given."""
    net, positive = work(2 * np.sin(TIME), 3 * np.sin(TIME), 0.01)
    assert net == pytest.approx(3 * (10 - np.sin(20) / 2), rel=1e-5)
    assert positive == net


def test_work_of_a_spring_over_whole_periods_is_nothing_but_what_it_gives_it_takes():
    """T = -k δ: over a quarter period it gives or takes k A² / 2."""
    time = np.linspace(0, 2 * np.pi, 10_001)
    net, positive = work(-4 * np.sin(time), np.cos(time), float(time[1]))
    assert net == pytest.approx(0, abs=1e-9)
    assert positive == pytest.approx(4.0, rel=1e-6)


def test_a_single_sample_does_no_work():
    assert work(np.ones(1), np.ones(1), 0.01) == (0, 0)


def test_reversals_of_a_sine_two_a_period():
    assert reversals(np.sin(2 * np.pi * TIME), 0.5) == 20


def test_smaller_turns_than_the_gap_do_not_count():
    assert reversals(0.2 * np.sin(2 * np.pi * TIME), 0.5) == 0


def test_noise_below_the_gap_changes_nothing():
    noise = 0.1 * np.random.default_rng(1).uniform(-1, 1, len(TIME))
    assert reversals(np.sin(2 * np.pi * TIME) + noise, 0.5) == 20


@pytest.mark.parametrize(
    ("angles", "count"),
    [
        ([0, 1, 2, 3], 0),
        ([0, 3, 2.5, 4], 0),
        ([0, 3, 1, 4], 2),
        ([0, -3, -1], 1),
        ([0, 0, 0], 0),
        ([0, 3, 2, 1, 0], 1),
        ([5], 0),
    ],
)
def test_reversals_of_a_few_turns(angles: list[float], count: int):
    assert reversals(np.array(angles, float), 1.0) == count
