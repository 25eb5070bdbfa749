"""Rides of the identified rider 184, made by a matrix exponential, not by the code under test."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.linalg import expm

from bikesim import bicycles
from bikesim.identify.estimate import Estimate, Estimator, Method
from bikesim.identify.ride import Ride
from bikesim.identify.structure import structure
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia, simulator_matrices

PERIOD, SPEED = 0.002, 3.19
# [S13], run 184; the neuromuscular lag 2π 2.17 rad/s, 1/√2.
GAINS = np.array([22.72, 26.12, 65.92, -3.0])
REMNANT = 10.0  # [rad/s]
OMEGA, ZETA = 2 * math.pi * 2.17, math.sqrt(0.5)
HARMONICS = (3, 5, 8, 11, 14, 19, 25, 32, 41, 53, 67, 85)
REPEAT = 30.0
SCHWAB = structure("schwab2013")
IV, PEM, LS = Method.INSTRUMENTAL_VARIABLE, Method.PREDICTION_ERROR, Method.LEAST_SQUARES


def multisine(seconds: float, rms: float = 5.0, harmonics=HARMONICS) -> np.ndarray:
    """A torque at each tick [N m], with Schroeder's phases."""
    time = np.arange(round(seconds / PERIOD)) * PERIOD
    k = np.arange(len(harmonics))
    phases = -np.pi * k * (k + 1) / len(harmonics)
    waves = np.cos(2 * np.pi / REPEAT * np.outer(time, harmonics) + phases)
    return rms * math.sqrt(2 / len(harmonics)) * waves.sum(axis=1)


def simulate(
    roll_moment: np.ndarray,
    remnants: Sequence[float] = (0.0,),
    *,
    damping: float = 0.0,
    seed: int = 1,
) -> list[Ride]:
    """A ride for each remnant [N m RMS], with the same disturbance, linear from tick to tick.

    The linear loop of eq. 7, the rider and the colour of his remnant (10 rad/s), moved on by the
    exponential of its matrix. `damping` [N m s/rad]: arms, which the torque recorded as the
    rider's is without.
    """
    bicycle = bicycles.load("davis")
    inertia = handlebar_inertia(bicycle, Law.PAPER)
    A, b = continuous(bicycle, inertia, damping)
    size = len(A)
    with_input = np.zeros((size + 2, size + 2))
    with_input[:size, :size], with_input[:size, size] = A * PERIOD, b * PERIOD
    with_input[size, size + 1] = 1.0
    moved = expm(with_input)[:size]
    kick = np.array(remnants) * math.sqrt(1 - math.exp(-2 * REMNANT * PERIOD))
    normals = np.random.default_rng(seed).standard_normal((len(roll_moment), len(remnants)))
    states = np.zeros((len(roll_moment), size, len(remnants)))
    states[0, -1] = remnants * normals[0]
    given = np.column_stack([roll_moment, np.append(np.diff(roll_moment), 0.0)])
    for tick in range(len(roll_moment) - 1):
        states[tick + 1] = moved[:, :size] @ states[tick] + (moved[:, size:] @ given[tick])[:, None]
        states[tick + 1, -1] += kick * normals[tick + 1]
    return [
        ride(roll_moment, states[:, :, i], A, bicycle, inertia, damping)
        for i in range(len(remnants))
    ]


def continuous(bicycle: Bicycle, inertia: float, damping: float) -> tuple[np.ndarray, np.ndarray]:
    """ẋ = A x + b T_φ of x = (φ, δ, φ̇, δ̇, ∫δ, muscle torque, its rate, remnant)."""
    mass, C, K = simulator_matrices(bicycle, Law.PAPER, SPEED, inertia)
    C = C + np.diag([0.0, damping])
    inverse = np.linalg.inv(mass)
    A, b = np.zeros((8, 8)), np.zeros(8)
    A[0:2, 2:4] = np.eye(2)
    A[2:4, 0:2], A[2:4, 2:4] = -inverse @ K, -inverse @ C
    A[2:4, 5] = A[2:4, 7] = inverse @ [0, 1]
    A[4, 1] = A[5, 6] = 1
    k_phi, k_phi_dot, k_int, k_delta_dot = GAINS
    A[6] = OMEGA**2 * np.array([k_phi, 0, k_phi_dot, k_delta_dot, k_int, -1, 0, 0])
    A[6, 6] = -2 * ZETA * OMEGA
    A[7, 7] = -REMNANT
    b[2:4] = inverse @ [1, 0]
    return A, b


def ride(
    roll_moment: np.ndarray,
    states: np.ndarray,
    A: np.ndarray,
    bicycle: Bicycle,
    inertia: float,
    damping: float,
) -> Ride:
    roll, steer, roll_rate, steer_rate, _, muscle, _, remnant = states.T
    torque = muscle + remnant
    # I δ̈ = T_δ - b δ̇ + T_f; the motor's torque counts as held until the next tick.
    (M_pp, _), (M_dp, _) = simulator_matrices(bicycle, Law.PAPER, SPEED, inertia)[0]
    acceleration = states @ A[3] - M_dp / (M_pp * inertia) * roll_moment
    feedback = inertia * acceleration - torque + damping * steer_rate
    held = 0.5 * (feedback + np.append(feedback[1:], feedback[-1]))
    return Ride(
        name="ride", bicycle=bicycle, law=Law.PAPER, inertia=inertia, rider="184", speed=SPEED,
        speed_range=0.0, fell=None, period=PERIOD, roll=roll, roll_rate=roll_rate, steer=steer,
        steer_rate=steer_rate, motor_torque=held, roll_moment=roll_moment,
        steer_moment=np.zeros_like(roll_moment), rider_torque=torque,
    )  # fmt: skip


def estimate(rides: list[Ride], method: Method, *free: str, from_bar: bool = False) -> Estimate:
    """Of the structure of run 184, with its lag."""
    return Estimator(rides, SCHWAB, SCHWAB.lags, free, from_bar=from_bar).estimate(method)


@pytest.fixture(scope="session")
def by_instrument(noisy: list[Ride]) -> list[Estimate]:
    """Each of the twelve alone."""
    return [estimate([ride], IV) for ride in noisy]


@pytest.fixture(scope="session")
def rides() -> list[Ride]:
    """Rides of 60 s: one without a remnant, twelve with 0.3 N m."""
    return simulate(multisine(60), [0.0] + 12 * [0.3])


@pytest.fixture(scope="session")
def exact(rides: list[Ride]) -> Ride:
    """Without a remnant."""
    return rides[0]


@pytest.fixture(scope="session")
def noisy(rides: list[Ride]) -> list[Ride]:
    """Twelve with a remnant of 0.3 N m."""
    return rides[1:]
