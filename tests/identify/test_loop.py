"""The model of the closed loop, against the state space of rider and simulator together."""

from dataclasses import replace

import numpy as np
import pytest

from bikesim.identify.loop import loop_response, modelled_torque, signal_of, simulated
from bikesim.identify.ride import Passive
from bikesim.identify.structure import Lags, structure
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia, simulator_matrices

from .conftest import GAINS, OMEGA, ZETA

FREQUENCY = np.array([0.3, 1.0, 3.0, 8.0, 20.0])
LAGS = Lags(0.0, OMEGA, ZETA)
SCHWAB = structure("schwab2013")


def state_space(ride, held: Passive, moments: tuple[float, float]):
    """ẋ = A x + b d of (φ, δ, φ̇, δ̇, ∫δ, T, Ṫ)."""
    mass, damping, stiffness = simulator_matrices(ride.bicycle, ride.law, ride.speed, ride.inertia)
    bar = np.diag([0.0, 1.0])
    mass = mass + held.inertia * bar
    inverse = np.linalg.inv(mass)
    A = np.zeros((7, 7))
    A[0:2, 2:4] = np.eye(2)
    A[2:4, 0:2] = -inverse @ (stiffness + held.stiffness * bar)
    A[2:4, 2:4] = -inverse @ (damping + held.damping * bar)
    A[2:4, 5] = inverse @ [0, 1]
    A[4, 1] = 1
    A[5, 6] = 1
    k_phi, k_phi_dot, k_int, k_delta_dot = GAINS
    A[6] = OMEGA**2 * np.array([k_phi, 0, k_phi_dot, k_delta_dot, k_int, -1, 0])
    A[6, 6] = -2 * ZETA * OMEGA
    b = np.zeros(7)
    b[2:4] = inverse @ moments
    return A, b


@pytest.mark.parametrize("held", [Passive(), Passive(0.1, 2.0, 5.0)])
@pytest.mark.parametrize("law", Law)
@pytest.mark.parametrize("moments", [(1.0, 0.0), (0.3, 1.0)])
def test_the_answer_is_that_of_the_state_space(exact, law: Law, held: Passive, moments):
    ride = replace(exact, law=law, passive=held, inertia=handlebar_inertia(exact.bicycle, law))
    both = (np.full(len(FREQUENCY), moment) for moment in moments)
    answer = loop_response(ride, SCHWAB, GAINS, LAGS, FREQUENCY, *both)
    A, b = state_space(ride, held, moments)
    expected = np.array([np.linalg.solve(1j * w * np.eye(7) - A, b) for w in FREQUENCY]).T
    for i, name in ((0, "roll"), (1, "steer"), (2, "roll_rate"), (3, "steer_rate")):
        assert signal_of(name, ride, answer) == pytest.approx(expected[i], rel=1e-9)
    assert signal_of("steer_integral", ride, answer) == pytest.approx(expected[4], rel=1e-9)
    torque = modelled_torque(ride, SCHWAB, GAINS, LAGS, answer)
    assert torque == pytest.approx(expected[5], rel=1e-9)


def test_the_path_follows_from_the_steer_by_equation_8(exact):
    ones = np.ones(len(FREQUENCY))
    answer = loop_response(exact, SCHWAB, GAINS, LAGS, FREQUENCY, ones, 0 * ones)
    s, b = 1j * FREQUENCY, exact.bicycle
    steer, steer_rate = (signal_of(name, exact, answer) for name in ("steer", "steer_rate"))
    heading, front = (signal_of(name, exact, answer) for name in ("heading", "front_y"))
    cosine = np.cos(b.steer_axis_tilt)
    yaw_rate = (exact.speed * steer + b.trail * steer_rate) * cosine / b.wheelbase
    assert s * heading == pytest.approx(yaw_rate, rel=1e-9)
    rear = front - b.wheelbase * heading + b.trail * steer * cosine
    assert s * rear == pytest.approx(exact.speed * heading, rel=1e-9)


def test_a_ride_without_remnant_is_what_the_loop_makes_of_its_disturbance(exact):
    modelled = simulated(exact, SCHWAB, GAINS, LAGS)
    settled = slice(round(8 / exact.period), None)
    for name in ("roll", "roll_rate", "steer_rate"):
        recorded = getattr(exact, name)[settled]
        assert np.std(modelled[name][settled] - recorded) < 1e-3 * np.std(recorded)


def test_with_haptics_off_a_disturbance_of_the_steer_never_comes_to_the_bar(exact):
    pushed = replace(exact, steer_moment=exact.roll_moment, roll_moment=0 * exact.roll_moment)
    off = replace(pushed, law=Law.OFF)
    assert simulated(pushed, SCHWAB, GAINS, LAGS)["steer_rate"].any()
    assert not simulated(off, SCHWAB, GAINS, LAGS)["steer_rate"].any()
