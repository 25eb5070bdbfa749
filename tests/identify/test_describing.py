"""Excitation and describing function, against what went in."""

from dataclasses import replace

import numpy as np
import pytest

from bikesim.identify.answer import Question
from bikesim.identify.describing import DescribingFunction, Identified, describing_function
from bikesim.identify.estimate import Estimate, Parameters
from bikesim.identify.excitation import excitation
from bikesim.identify.ride import Passive, Ride
from bikesim.identify.rider import identify_rider
from bikesim.identify.structure import Lags
from bikesim.model.simulator import simulator_matrices

from .conftest import (
    GAINS,
    HARMONICS,
    OMEGA,
    PERIOD,
    REPEAT,
    SCHWAB,
    SPEED,
    ZETA,
    multisine,
    simulate,
)

TRUTH = Parameters(GAINS, Lags(0.0, OMEGA, ZETA))


def of_truth(ride: Ride) -> DescribingFunction:
    rider = Identified(SCHWAB, TRUTH, [np.zeros(len(ride.roll))], False)
    return describing_function([ride], excitation([ride]), rider)


def test_the_lines_of_a_multisine(exact: Ride):
    found = excitation([exact])
    assert found.lines == 12
    frequency = [band.frequency for band in found.bands]
    assert frequency == pytest.approx(2 * np.pi / REPEAT * np.array(HARMONICS), rel=0.005)


@pytest.mark.parametrize("harmonics", [(10,), (10, 40), (3, 5, 8)])
def test_few_lines_and_close_ones(exact: Ride, harmonics: tuple[int, ...]):
    ride = replace(exact, roll_moment=multisine(60, harmonics=harmonics))
    assert excitation([ride]).lines == len(harmonics)


def test_a_push_excites_a_band(exact: Ride):
    push = np.zeros_like(exact.roll)
    push[10000:10100] = 20.0
    assert excitation([replace(exact, roll_moment=push)]).lines > 12


def true_function(frequency: np.ndarray, ride: Ride, arm_damping: float = 0.0) -> np.ndarray:
    """T/φ of a rider with the true gains under a roll moment, by the second row of eq. 7 alone.

    It has no roll moment in it: T = (...)φ + (...)δ; and the rider is T = (...)φ + (...)δ too. With
    `arm_damping` [N m s/rad], T is that of brain and arms together.
    """
    s = 1j * frequency
    mass, damping, stiffness = simulator_matrices(ride.bicycle, ride.law, SPEED, ride.inertia)
    lower = [s * s * mass[1, i] + s * damping[1, i] + stiffness[1, i] for i in (0, 1)]
    lag = OMEGA**2 / (s * s + 2 * ZETA * OMEGA * s + OMEGA**2)
    k_phi, k_phi_dot, k_int, k_delta_dot = GAINS
    of_roll, of_steer = lag * (k_phi + k_phi_dot * s), lag * (k_int / s + k_delta_dot * s)
    of_steer = of_steer - arm_damping * s
    # of_roll φ + of_steer δ = lower[0] φ + lower[1] δ
    steer_per_roll = (lower[0] - of_roll) / (of_steer - lower[1])
    return of_roll + of_steer * steer_per_roll


def test_without_a_remnant_it_is_the_riders_law(exact: Ride):
    found = of_truth(exact)
    expected = true_function(found.frequency, exact)
    assert np.abs(found.measured / expected - 1).max() < 0.005
    assert found.model == pytest.approx(true_function(found.model_frequency, exact), rel=1e-9)


@pytest.mark.parametrize("arms", [True, False])
def test_arms_that_are_in_the_torque_of_the_bar_are_not_in_the_loop_too(arms: bool):
    """A record that tells of them, as ours do, has the describing function of the true loop."""
    damping = 1.0
    (made,) = simulate(multisine(60), damping=damping)
    ride = replace(made, passive=Passive(damping=damping))
    asked = Question(arms=True) if arms else Question(torque="bar", muscle_frequency="free")
    found = identify_rider([ride], asked)
    assert (found.torque, found.lines) == ("bar", 12)
    described = found.describing
    assert described is not None
    inside = (described.model_frequency > 1) & (described.model_frequency < 12)
    true = true_function(described.model_frequency, ride, damping)
    off = np.abs(described.model / true - 1)[inside]
    assert off.max() < (0.02 if arms else 0.3)
    bare = identify_rider([made], asked).describing
    assert bare is not None
    assert described.model == pytest.approx(bare.model, rel=1e-9)
    assert described.standard_error == pytest.approx(bare.standard_error, rel=1e-9)


def test_its_errors_are_honest(noisy: list[Ride], by_instrument: list[Estimate]):
    """Of each of the twelve lines, over twelve rides: real and imaginary part over their error."""
    distances = []
    for ride, estimated in zip(noisy, by_instrument, strict=True):
        rider = Identified(SCHWAB, estimated.parameters, estimated.residual, False)
        found = describing_function([ride], excitation([ride]), rider)
        off = (found.measured - true_function(found.frequency, ride)) / found.standard_error
        distances.append(np.stack([off.real, off.imag]))
    spread = np.sqrt(np.mean(np.square(distances), axis=(0, 1)))
    assert (spread < 1.9).all()
    assert 0.8 < np.sqrt(np.mean(np.square(distances))) < 1.3


def test_a_push_shows_it_too():
    moment = np.zeros(round(30 / PERIOD))
    for first in (3000, 6000, 9000, 12000):
        moment[first : first + 100] = 10.0
    (ride,) = simulate(moment)
    found = of_truth(ride)
    slow = found.frequency < 10
    expected = true_function(found.frequency, ride)
    assert np.median(np.abs(found.measured / expected - 1)[slow]) < 0.1
