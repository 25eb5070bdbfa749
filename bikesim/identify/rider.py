"""Which gains a rider rode with: from his records, with intervals and what speaks against them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.identify.answer import (
    Fit,
    Identification,
    IdentifiedGain,
    Question,
    TorqueSource,
)
from bikesim.identify.describing import Identified, describing_function
from bikesim.identify.diagnosis import warnings
from bikesim.identify.estimate import FREE_LAGS, Estimate, Estimator, Method
from bikesim.identify.excitation import excitation
from bikesim.identify.regressors import SETTLING, block_ticks, settled
from bikesim.identify.ride import Passive, Ride, check_together
from bikesim.identify.structure import Gain, Lags, Structure, Vector, structure


def identify_rider(rides: Sequence[Ride], question: Question) -> Identification:
    """The gains of one rider from one or several of his rides. Raises InputError."""
    check_together(rides)
    asked = structure(question.structure, arms=question.arms)
    lags, free = _lags(asked, question)
    source = _source(rides, question)
    if source == "bar":
        # The arms are in the torque, so nothing beside it holds the bar.
        rides = [replace(ride, passive=Passive()) for ride in rides]
    method = _method(rides, question)
    _check_possible(rides, asked)
    estimator = Estimator(rides, asked, lags, free, from_bar=source == "bar")
    biased = estimator.estimate(Method.LEAST_SQUARES)
    best = biased if method is Method.LEAST_SQUARES else estimator.estimate(method)
    names = (*asked.gains, *(Gain(name, _UNITS[name]) for name in free))
    values, covariance = _gains(asked, free, best)
    with_bias, _ = _gains(asked, free, biased)
    fits = tuple(_fits(rides, best))
    vaf = _vaf(best)
    excited = excitation(rides) if rides[0].disturbed else None
    error = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(error, error)
    lines = None if excited is None else excited.lines
    return Identification(
        question=question,
        structure=asked,
        method=method,
        torque=source,
        rides=tuple(rides),
        gains=tuple(_told(names, values, error, with_bias, question.confidence)),
        lags=best.parameters.lags,
        free=free,
        duration=sum(ride.duration - SETTLING for ride in rides),
        vaf=vaf,
        least_squares_vaf=_vaf(biased),
        noise_rms=float(np.std(np.concatenate(best.residual))),
        lines=lines,
        condition=best.condition,
        strength=best.strength,
        correlation=correlation,
        fits=fits,
        describing=(
            describing_function(
                rides, excited, Identified(asked, best.parameters, best.residual, source == "bar")
            )
            if excited is not None and excited.lines
            else None
        ),
        warnings=warnings(
            rides,
            best,
            method=method,
            names=[gain.name for gain in names],
            free=free,
            lines=lines,
            vaf=vaf,
        ),
    )


_UNITS = {"delay": "s", "muscle_frequency": "rad/s"}


def _lags(asked: Structure, question: Question) -> tuple[Lags, tuple[str, ...]]:
    lags, free = asked.lags, []
    for name in FREE_LAGS:
        value = getattr(question, name)
        if value == "free" or (value is None and name in asked.free):
            free.append(name)
        elif value is not None:
            lags = lags._replace(**{name: value})
    if question.muscle_damping_ratio is not None:
        lags = lags._replace(muscle_damping_ratio=question.muscle_damping_ratio)
    return lags, tuple(free)


def _source(rides: Sequence[Ride], question: Question) -> TorqueSource:
    """The rider's own torque where it is recorded; with his arms' share, only the bar knows it."""
    recorded = rides[0].rider_torque is not None
    if question.torque == "rider" and not recorded:
        raise InputError(f"{rides[0].name}: has no channel rider_torque; --torque bar computes it")
    if question.torque == "rider" and question.arms:
        raise InputError(
            "--arms with --torque rider: the channel rider_torque is without the arms; "
            "leave --torque out"
        )
    return question.torque or ("rider" if recorded and not question.arms else "bar")


def _method(rides: Sequence[Ride], question: Question) -> Method:
    disturbed = rides[0].disturbed
    if question.method is Method.INSTRUMENTAL_VARIABLE and not disturbed:
        raise InputError(
            f"{rides[0].name}: no disturbance is in the record, and the instrumental variable "
            "needs one; --method prediction-error does not"
        )
    if question.method is not None:
        return question.method
    return Method.INSTRUMENTAL_VARIABLE if disturbed else Method.PREDICTION_ERROR


def _check_possible(rides: Sequence[Ride], asked: Structure) -> None:
    arms = any(term.through == "arms" for term in asked.terms)
    if arms and not rides[0].disturbed:
        raise InputError(
            f"{rides[0].name}: without a known disturbance, arms cannot be told from the bicycle "
            "itself; leave --arms out"
        )
    if asked.straight_only and (turning := [ride.name for ride in rides if not ride.straight]):
        raise InputError(
            f"{turning[0]}: its path is not straight; structure {asked.name} is identified on a "
            "straight one only"
        )


def _gains(
    asked: Structure, free: Sequence[str], estimate: Estimate
) -> tuple[Vector, NDArray[np.floating[Any]]]:
    """Gains and free lags with their covariance, by the slope of what makes them."""
    coefficients = estimate.parameters.coefficients
    terms, count = len(coefficients), len(estimate.covariance)
    slope = np.eye(count)
    for i, error in enumerate(np.sqrt(np.diag(estimate.covariance))[:terms]):
        step = np.zeros(terms)
        step[i] = 1e-4 * error
        more, less = (asked.to_gains(coefficients + sign * step) for sign in (1, -1))
        slope[:terms, i] = (more - less) / (2 * step[i])
    lags = [getattr(estimate.parameters.lags, name) for name in free]
    values = np.concatenate([asked.to_gains(coefficients), lags])
    return values, slope @ estimate.covariance @ slope.T


def _told(
    names: Sequence[Gain], values: Vector, error: Vector, biased: Vector, confidence: float
) -> list[IdentifiedGain]:
    from scipy.special import ndtri

    wide = float(ndtri(0.5 + confidence / 2)) * error
    return [
        IdentifiedGain(
            gain.name,
            gain.unit,
            float(values[i]),
            float(error[i]),
            float(values[i] - wide[i]),
            float(values[i] + wide[i]),
            float(biased[i]),
        )
        for i, gain in enumerate(names)
    ]


def _fits(rides: Sequence[Ride], estimate: Estimate) -> list[Fit]:
    found = []
    for ride, modelled, residual in zip(rides, estimate.modelled, estimate.residual, strict=True):
        block = block_ticks(ride.period) * ride.period
        time = (settled(ride) + 0.5 + np.arange(len(modelled))) * block
        found.append(Fit(time, modelled + residual, modelled))
    return found


def _vaf(estimate: Estimate) -> float:
    left = sum(float(np.sum((e - e.mean()) ** 2)) for e in estimate.residual)
    torques = [m + e for m, e in zip(estimate.modelled, estimate.residual, strict=True)]
    return 100 * (1 - left / sum(float(np.sum((t - t.mean()) ** 2)) for t in torques))
