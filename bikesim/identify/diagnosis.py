"""What a user must be warned of before he believes identified gains."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.identify.estimate import FREE_LAGS, Estimate, Method
from bikesim.identify.regressors import SETTLING
from bikesim.identify.ride import STATIONARY, Ride

LARGEST_CONDITION = 30.0
"""Of columns of length 1: above it they are near collinear [Belsley, Kuh & Welsch 1980]."""
LARGEST_CORRELATION = 0.98
WEAKEST = 10.0
"""Of an instrument, below which its intervals are not to be trusted [Staiger & Stock 1997]."""
_SHORT = 20.0  # [s]
_LITTLE = 50.0  # [%]


def warnings(
    rides: Sequence[Ride],
    estimate: Estimate,
    *,
    method: Method,
    names: Sequence[str],
    free: Sequence[str],
    lines: int | None,
    vaf: float,
) -> tuple[str, ...]:
    """One line each, the gravest first. `lines` excited, None without a known disturbance."""
    return (
        *_of_method(method, lines),
        *_of_excitation(estimate, names, lines),
        *_of_solution(estimate, free),
        *_of_rides(rides),
        *_of_fit(vaf),
    )


def _of_method(method: Method, lines: int | None) -> list[str]:
    if lines is None:
        return [
            "no known disturbance is in the record, so only a fit that may be biased is possible: "
            "all that the rider sees comes from his own noise, and nothing but the assumed colour "
            "of that noise tells his answer from the bicycle's"
        ]
    if method is Method.LEAST_SQUARES:
        return ["least squares is biased in a closed loop: the remnant moves the bicycle too"]
    if method is Method.PREDICTION_ERROR:
        return ["prediction error is biased where the noise is not as assumed or a sensor is noisy"]
    return []


def _of_excitation(
    estimate: Estimate,
    names: Sequence[str],
    lines: int | None,
) -> list[str]:
    found = []
    if lines is not None and lines < len(names):
        found.append(
            f"the disturbance excites {lines} {'frequency' if lines == 1 else 'frequencies'}, "
            f"fewer than the {len(names)} unknowns: the gains rest on the structure"
        )
    pairs = _alike(names, estimate.covariance)
    if estimate.condition > LARGEST_CONDITION or pairs:
        found.append(
            f"the excitation cannot tell all gains apart (condition {estimate.condition:.0f}"
            + (f"; {', '.join(pairs)} trade against each other)" if pairs else ")")
        )
    if estimate.strength < WEAKEST:
        found.append(
            f"the disturbance moves the signals too little beside the noise (first stage F "
            f"{estimate.strength:.1f}, below {WEAKEST:g}): the intervals are not to be trusted"
        )
    return found


def _alike(names: Sequence[str], covariance: NDArray[np.floating[Any]]) -> list[str]:
    """Of the coefficients: gains of nested loops are ratios of them, and alike without harm."""
    error = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(error, error)
    first, second = np.triu_indices(len(names), 1)
    return [
        f"{names[i]} and {names[j]}"
        for i, j in zip(first.tolist(), second.tolist(), strict=True)
        if abs(correlation[i, j]) > LARGEST_CORRELATION
    ]


def _of_solution(estimate: Estimate, free: Sequence[str]) -> list[str]:
    found = []
    for name in free:
        value, bounds = getattr(estimate.parameters.lags, name), FREE_LAGS[name]
        if value in (bounds.least, bounds.most):
            found.append(f"{name} ran to its bound, {value:g}: the structure does not fit")
    if not estimate.converged:
        found.append("the iteration did not converge: the figures are those of its last step")
    return found


def _of_rides(rides: Sequence[Ride]) -> list[str]:
    found = [
        f"{ride.name}: fell at {ride.fell:.2f} s; only the {ride.duration:.2f} s before are used"
        for ride in rides
        if ride.fell is not None
    ]
    found += [
        f"{ride.name}: the speed changes by {ride.speed_range:.2g} m/s; the gains are of its mean"
        for ride in rides
        if ride.speed_range > STATIONARY * abs(ride.speed)
    ]
    used = sum(ride.duration - SETTLING for ride in rides)
    if used < _SHORT:
        found.append(f"only {used:.1f} s are used: intervals of short records may be too narrow")
    return found


def _of_fit(vaf: float) -> list[str]:
    if vaf < _LITTLE:
        return [f"the structure explains only {vaf:.0f} % of the torque"]
    return []
