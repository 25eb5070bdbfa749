"""Gains of a rider whose gains are known: [S13], run 184, in rides that the conftest simulates."""

from dataclasses import replace

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.identify.estimate import Estimate, Estimator, Method
from bikesim.identify.ride import Ride
from bikesim.identify.structure import structure

from .conftest import GAINS, IV, LS, OMEGA, PEM, estimate, multisine, simulate


def values(found: list[Estimate]) -> tuple[np.ndarray, np.ndarray]:
    gains = np.array([one.parameters.coefficients for one in found])
    errors = np.array([np.sqrt(np.diag(one.covariance)) for one in found])
    return gains, errors


@pytest.mark.parametrize("method", Method)
def test_without_a_remnant_each_method_finds_the_gains(exact: Ride, method: Method):
    """What is seen is continuous in these rides, and taken to be held: half a tick is between."""
    found = estimate([exact], method)
    assert found.parameters.coefficients == pytest.approx(GAINS, rel=0.02)
    assert found.converged


def test_the_intervals_of_the_instrument_hold_the_truth(by_instrument: list[Estimate]):
    gains, errors = values(by_instrument)
    inside = np.abs(gains - GAINS) < 1.96 * errors
    assert (inside.sum(axis=0) >= 10).all()
    # Of the mean of twelve: within three of its standard errors, and not for being too wide.
    assert (np.abs(gains.mean(axis=0) - GAINS) < 3 * errors.mean(axis=0) / np.sqrt(12)).all()
    assert 0.75 < np.sqrt(np.mean(((gains - GAINS) / errors) ** 2)) < 1.3
    assert all(one.converged for one in by_instrument)


def test_least_squares_is_biased(noisy: list[Ride], by_instrument: list[Estimate]):
    gains, _ = values([estimate([ride], LS) for ride in noisy])
    error = gains.std(axis=0, ddof=1) / np.sqrt(12)
    assert (np.abs(gains.mean(axis=0) - GAINS) > 5 * error).all()
    assert (np.abs(gains.mean(axis=0)) < np.abs(values(by_instrument)[0].mean(axis=0))).all()


def test_several_records_together_say_more(noisy: list[Ride], by_instrument: list[Estimate]):
    found = estimate(noisy[:4], IV)
    error = np.sqrt(np.diag(found.covariance))
    _, alone = values(by_instrument[:4])
    assert error == pytest.approx(alone.mean(axis=0) / 2, rel=0.15)
    assert (np.abs(found.parameters.coefficients - GAINS) < 3 * error).all()


def test_the_bar_alone_gives_the_same_gains(noisy: list[Ride], by_instrument: list[Estimate]):
    found = estimate([replace(noisy[0], rider_torque=None)], IV, from_bar=True)
    _, error = values(by_instrument[:1])
    moved = found.parameters.coefficients - by_instrument[0].parameters.coefficients
    assert (np.abs(moved) < 0.5 * error[0]).all()


def test_noise_of_the_sensors_biases_least_squares_and_not_the_instrument(exact: Ride):
    random = np.random.default_rng(2)
    noise = random.standard_normal(len(exact.steer_rate))
    measured = replace(exact, steer_rate=exact.steer_rate + noise)
    instrument, squares = (estimate([measured], method) for method in (IV, LS))
    error = np.sqrt(np.diag(instrument.covariance))
    assert (np.abs(instrument.parameters.coefficients - GAINS) < 3 * error).all()
    assert squares.parameters.coefficients[3] > GAINS[3] + 5 * error[3]


@pytest.mark.parametrize("method", [IV, PEM])
def test_a_lag_that_is_not_known(exact: Ride, method: Method):
    found = estimate([exact], method, "muscle_frequency")
    assert found.parameters.lags.muscle_frequency == pytest.approx(OMEGA, rel=0.03)
    assert found.parameters.coefficients == pytest.approx(GAINS, rel=0.05)


def test_without_a_disturbance_the_noise_alone_tells_if_it_is_as_assumed():
    rides = simulate(np.zeros(30_000), 4 * [0.3])
    found = estimate(rides, PEM)
    error = np.sqrt(np.diag(found.covariance))
    assert found.converged
    assert (np.abs(found.parameters.coefficients - GAINS) < 3 * error).all()
    biased = estimate(rides, LS)
    assert (np.abs(biased.parameters.coefficients - GAINS) > 3 * error)[[0, 1, 3]].all()


def test_arms_are_found_in_the_torque_of_the_bar():
    (ride,) = simulate(multisine(30), damping=0.5)
    found = structure("schwab2013", arms=True)
    result = Estimator([ride], found, found.lags, from_bar=True).estimate(IV)
    gains = found.to_gains(result.parameters.coefficients)
    assert gains == pytest.approx([*GAINS, 0.0, 0.5, 0.0], rel=0.03, abs=0.2)


def test_what_cannot_be_estimated(exact: Ride):
    every = {"roll", "roll_rate", "steer", "steer_rate", "motor_torque", "roll_moment"}
    short = {name: getattr(exact, name)[:1600] for name in (*every, "steer_moment", "rider_torque")}
    with pytest.raises(InputError, match=r"ride: 3.20 s: too short for 4 gains; at least"):
        estimate([replace(exact, **short)], IV)
    with pytest.raises(InputError, match="torque never changes: nobody steers"):
        estimate([replace(exact, rider_torque=np.zeros_like(exact.roll))], IV)
    still = {name: np.zeros_like(exact.roll) for name in every - {"motor_torque"}}
    with pytest.raises(InputError, match="cannot tell the gains apart at all"):
        estimate([replace(exact, **still)], LS)
