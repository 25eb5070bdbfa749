"""Linear riders: against published eigenvalues, transfer functions, the exact delay."""

import cmath

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.model.eigen import bicycle_modes, simulator_modes
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.rider.linear import closed_loop, delay_state_space, linear_rider, spectral_abscissa
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS
from bikesim.rider.settings import RiderSettings

BENCHMARK = bicycles.load("benchmark")
DAVIS = bicycles.load("davis")
HUMAN = RiderSettings(name="human")


def figure(value: float | None) -> float:
    assert value is not None
    return value


def in_order(values) -> np.ndarray:
    return np.sort_complex(np.asarray(values, complex))


# SCIENCE.md section 3, run 184 at 3.19 m/s: three pairs; the seventh is real and far off.
@pytest.mark.parametrize(
    ("law", "pairs"),
    [
        (None, (-0.781 + 2.505j, -1.484 + 4.933j, -1.958 + 11.806j)),
        (Law.PAPER, (-0.746 + 2.439j, -1.785 + 5.852j, -2.197 + 10.406j)),
        (Law.MOMENTUM, (-0.781 + 2.505j, -1.484 + 4.933j, -1.958 + 11.806j)),
    ],
)
def test_run_184_has_the_known_eigenvalues(law: Law | None, pairs: tuple[complex, ...]):
    rider = linear_rider(RiderSettings(name="schwab2013-184"))
    values = np.linalg.eigvals(closed_loop(DAVIS, 3.19, rider, law=law))
    above = values[values.imag > 0]
    np.testing.assert_allclose(in_order(above), in_order(pairs), atol=6e-4)


def test_run_184_without_haptics_has_the_known_unstable_pair():
    rider = linear_rider(RiderSettings(name="schwab2013-184"))
    values = np.linalg.eigvals(closed_loop(DAVIS, 3.19, rider, law=Law.OFF))
    worst = max(values, key=lambda s: (s.real, s.imag))
    assert abs(worst - (3.830 + 11.142j)) < 8e-4


@pytest.mark.parametrize("law", [None, Law.PAPER, Law.MOMENTUM])
def test_all_identified_riders_are_stable_with_haptics(law: Law | None):
    rates = [
        spectral_abscissa(
            closed_loop(
                DAVIS,
                run.speed,
                linear_rider(RiderSettings(name=f"schwab2013-{run.run}")),
                law=law,
            )
        )
        for run in IDENTIFIED_RUNS
    ]
    assert len(rates) == 15
    assert max(rates) < 0


def test_all_identified_riders_are_unstable_without_haptics():
    rates = [
        spectral_abscissa(
            closed_loop(
                DAVIS,
                run.speed,
                linear_rider(RiderSettings(name=f"schwab2013-{run.run}")),
                law=Law.OFF,
            )
        )
        for run in IDENTIFIED_RUNS
    ]
    assert min(rates) == pytest.approx(2.99, abs=0.005)
    assert max(rates) == pytest.approx(7.36, abs=0.005)


@pytest.mark.parametrize("frequency", [0.0, 1.0, 5.0, 12.0])
@pytest.mark.parametrize("delay", [0.02, 0.2, 0.4])
def test_the_delay_line_is_the_exact_delay_in_the_range_that_matters(
    delay: float, frequency: float
):
    A, B = delay_state_space(delay)
    s = 1.0 + 1j * frequency
    out = np.linalg.solve(s * np.eye(len(A)) - A, B)[:, 0].sum()
    assert abs(out - cmath.exp(-s * delay)) < 1e-5


@pytest.mark.parametrize("delay", [0.0, 0.2])
def test_a_roll_pd_rider_has_his_transfer_function(delay: float):
    rider = linear_rider(RiderSettings(name="human", visual_delay=delay))
    s = 2.0j
    found = rider.C @ np.linalg.solve(s * np.eye(len(rider.A)) - rider.A, rider.B)
    muscle = 30.0**2 / (s * s + 2 * 0.707 * 30.0 * s + 30.0**2)
    late = muscle * cmath.exp(-s * delay)
    gains = (figure(HUMAN.roll_gain), 0.0, figure(HUMAN.roll_rate_gain), 0.0)
    np.testing.assert_allclose(found, late * np.array(gains), atol=1e-9)


def test_an_identified_rider_has_his_transfer_function():
    run = next(run for run in IDENTIFIED_RUNS if run.run == 184)
    rider = linear_rider(RiderSettings(name="schwab2013-184"))
    s = 3.0j
    found = rider.C @ np.linalg.solve(s * np.eye(3) - rider.A, rider.B)
    w = 2 * np.pi * 2.17
    muscle = w**2 / (s * s + np.sqrt(2) * w * s + w**2)
    gains = (run.roll, run.steer_integral / s, run.roll_rate, run.steer_rate)
    np.testing.assert_allclose(found, muscle * np.array(gains), rtol=1e-12)


def test_each_sense_has_its_own_delay():
    """y = (φ, δ, φ̇, δ̇) by eyes, balance organs and hands, against the transfer functions."""
    settings = RiderSettings(
        name="schwab2013-184", visual_delay=0.1, vestibular_delay=0.05, vestibular_share=0.25,
        proprioceptive_delay=0.02,
    )  # fmt: skip
    rider, s = linear_rider(settings), 3.0j
    found = rider.C @ np.linalg.solve(s * np.eye(len(rider.A)) - rider.A, rider.B)
    run = next(run for run in IDENTIFIED_RUNS if run.run == 184)
    w = 2 * np.pi * 2.17
    muscle = w**2 / (s * s + np.sqrt(2) * w * s + w**2)
    eyes, organs, hands = (cmath.exp(-s * delay) for delay in (0.1, 0.05, 0.02))
    gains = (
        run.roll * eyes,
        run.steer_integral / s * hands,
        run.roll_rate * (0.75 * eyes + 0.25 * organs),
        run.steer_rate * hands,
    )
    np.testing.assert_allclose(found, muscle * np.array(gains), rtol=1e-9)


@pytest.mark.parametrize("name", ["hess2012", "lqr", "torque-step", "mine.py:Mine"])
def test_a_rider_who_is_no_set_of_gains_has_no_linear_form_here(name: str):
    with pytest.raises(InputError, match="has no linear form here; those who have: human, pd"):
        linear_rider(RiderSettings(name=name))


@pytest.mark.parametrize("law", list(Law))
def test_without_a_rider_the_loop_is_the_simulator(law: Law):
    loop = closed_loop(BENCHMARK, 3.5, linear_rider(RiderSettings(name="hands-off")), law=law)
    modes = simulator_modes(BENCHMARK, law, 3.5).all()
    np.testing.assert_allclose(in_order(np.linalg.eigvals(loop)), in_order(modes), atol=1e-7)


def test_without_a_rider_and_law_the_loop_is_the_bicycle():
    loop = closed_loop(BENCHMARK, 5.0, linear_rider(RiderSettings(name="hands-off")), law=None)
    modes = bicycle_modes(BENCHMARK, 5.0).all()
    np.testing.assert_allclose(in_order(np.linalg.eigvals(loop)), in_order(modes), atol=1e-10)


def residual(s: complex, rider: RiderSettings, law: Law) -> complex:
    """The characteristic function with the exact delay and the arms on the bar."""
    mass, damping, stiffness = simulator_matrices(BENCHMARK, law, 3.5)
    A = s * s * mass + s * damping + stiffness + 0j
    A[1, 1] += figure(rider.arm_inertia) * s * s
    A[1, 1] += figure(rider.arm_damping) * s + figure(rider.arm_stiffness)
    muscle = 30.0**2 / (s * s + 2 * 0.707 * 30.0 * s + 30.0**2)
    seen = figure(rider.roll_gain) + figure(rider.roll_rate_gain) * s
    A[1, 0] -= seen * muscle * cmath.exp(-figure(rider.visual_delay) * s)
    return complex(A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0])


@pytest.mark.parametrize("law", list(Law))
@pytest.mark.parametrize("delay", [0.0, 0.05, 0.2, 0.4, 0.56])
def test_the_slow_modes_of_a_roll_pd_rider_solve_the_exact_equation(delay: float, law: Law):
    rider = RiderSettings(name="human", visual_delay=delay)
    values = np.linalg.eigvals(closed_loop(BENCHMARK, 3.5, linear_rider(rider), law=law))
    slow = [complex(s) for s in values if abs(s) < 8]
    assert slow
    for s in slow:
        slope = (residual(s + 1e-6, rider, law) - residual(s - 1e-6, rider, law)) / 2e-6
        assert abs(residual(s, rider, law) / slope) < 1e-5  # Newton's next step [1/s]


def test_the_default_rider_is_stable_with_haptics_only():
    rider = linear_rider(HUMAN)
    assert spectral_abscissa(closed_loop(BENCHMARK, 3.5, rider, law=Law.PAPER)) < 0
    assert spectral_abscissa(closed_loop(BENCHMARK, 3.5, rider, law=Law.OFF)) > 2
