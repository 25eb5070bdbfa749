import math

import numpy as np
import pytest
from scipy.signal import freqs, lsim

from bikesim.rider.muscle import Neuromuscular, Strength

OMEGA, ZETA = 30.0, 0.707  # [H12]
G_NM = ([OMEGA**2], [1, 2 * ZETA * OMEGA, OMEGA**2])


@pytest.mark.parametrize("step", [1e-4, 1e-3, 1e-2])
def test_the_answer_to_a_step_is_exact(step: float):
    muscle = Neuromuscular(OMEGA, ZETA, step)
    ours = [muscle.follow(1.0) for _ in range(200)]
    times = step * np.arange(1, 201)
    decay, damped = ZETA * OMEGA, OMEGA * math.sqrt(1 - ZETA**2)
    theirs = 1 - np.exp(-decay * times) * (
        np.cos(damped * times) + decay / damped * np.sin(damped * times)
    )
    assert ours == pytest.approx(theirs, abs=1e-12)


def test_the_answer_to_any_held_torque_is_scipys():
    intended = np.random.default_rng(1).normal(size=300)
    muscle = Neuromuscular(OMEGA, ZETA, 2e-3)
    ours = [muscle.follow(value) for value in intended]
    times = 2e-3 * np.arange(301)
    _, theirs, _ = lsim(G_NM, [*intended, 0.0], times, interp=False)
    assert ours == pytest.approx(theirs[1:], abs=1e-11)


@pytest.mark.parametrize("frequency", [3.0, 30.0, 90.0])
def test_the_frequency_response_is_that_of_the_filter(frequency: float):
    step, muscle = 1e-4, Neuromuscular(OMEGA, ZETA, 1e-4)
    times = step * np.arange(40_000)
    out = np.array([muscle.follow(value) for value in np.sin(frequency * times)])
    # Half a step: the intended torque is held over one.
    late = times[-20_000:] + step / 2
    basis = np.column_stack([np.sin(frequency * late), np.cos(frequency * late)])
    (in_phase, quadrature), *_ = np.linalg.lstsq(basis, out[-20_000:], rcond=None)
    _, response = freqs(*G_NM, worN=[frequency])
    assert complex(in_phase, quadrature) == pytest.approx(complex(response[0]), abs=1e-3)


@pytest.mark.parametrize(("frequency", "ratio"), [(1000.0, 0.7), (1000.0, 10.0), (30.0, 1.0)])
def test_any_muscle_that_may_be_set_settles_at_the_intended_torque(frequency: float, ratio: float):
    """Also where the physics step is much longer than its time constant."""
    muscle = Neuromuscular(frequency, ratio, 0.01)
    torque = 0.0
    for _ in range(200):
        torque = muscle.follow(2.0)
    assert torque == pytest.approx(2.0, rel=1e-6)


def test_muscles_of_many_are_those_of_each_to_the_bit():
    frequencies, ratios = np.array([30.0, 13.6, 30.0]), np.array([0.707, 0.5, 0.9])
    intended = np.random.default_rng(1).normal(size=(500, 3))
    many = Neuromuscular(frequencies, ratios, 5e-4, many=True)
    together = [many.follow(row).tolist() for row in intended]
    for i in range(3):
        one = Neuromuscular(float(frequencies[i]), float(ratios[i]), 5e-4)
        alone = [one.follow(value) for value in intended[:, i].tolist()]
        assert [row[i] for row in together] == alone


def test_relaxed_they_are_at_rest():
    used, fresh = (Neuromuscular(OMEGA, ZETA, 1e-3) for _ in range(2))
    for _ in range(50):
        used.follow(3.0)
    used.relax(True)
    assert [used.follow(1.0) for _ in range(50)] == [fresh.follow(1.0) for _ in range(50)]


def test_those_relax_who_are_told_to():
    one, many = Neuromuscular(OMEGA, ZETA, 1e-3), Neuromuscular(OMEGA, ZETA, 1e-3, many=True)
    for _ in range(50):
        on, both = one.follow(3.0), many.follow(np.full(2, 3.0))
        assert both.tolist() == [on, on]
    many.relax(np.array([False, True]))
    fresh = Neuromuscular(OMEGA, ZETA, 1e-3)
    assert many.follow(np.ones(2)).tolist() == [one.follow(1.0), fresh.follow(1.0)]


@pytest.mark.parametrize("value", [-3.0, -0.5, 0.0, 0.7, 2.0, 9.0])
def test_strength_ends_at_its_limit(value: float):
    assert Strength(2.0)(value) == max(-2.0, min(2.0, value))
    limits = np.array([1.0, np.inf])
    assert Strength(limits)(np.full(2, value)).tolist() == [max(-1.0, min(1.0, value)), value]
