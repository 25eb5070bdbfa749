"""Coefficients and lags from records: least squares, prediction error, instrumental variable.

All three solve Zᵀ L e(p) = 0 for the parameters p, by Gauss and Newton: e is the torque that the
structure leaves, L what whitens it, Ψ = -∂e/∂p by the recorded signals.

- least squares: Z = Ψ, L = 1. Biased: the remnant moves the bicycle, and so the signals.
- prediction error: Z = L Ψ, L from the residual. Unbiased if L is right and nothing else is noisy.
- instrumental variable: Z is L Ψ by the signals that the known disturbance alone would have caused
  in the closed loop. They know nothing of the remnant nor of the sensors' noise, so it is unbiased
  whatever L and the model of the loop; these decide how wide the intervals are. With the loop's
  true model and noise no instrument gives narrower ones [Söderström & Stoica 1983; refined for
  closed loops by Gilson, Garnier, Young & Van den Hof 2011].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.identify.loop import simulated
from bikesim.identify.noise import WHITE, autoregression, before, whitened
from bikesim.identify.regressors import Signals, columns, recorded, settled, torque
from bikesim.identify.ride import Ride
from bikesim.identify.structure import Lags, Structure, Vector
from bikesim.identify.system import System

Columns = NDArray[np.floating[Any]]


class Method(StrEnum):
    """How the parameters are found; see the module."""

    INSTRUMENTAL_VARIABLE = "instrumental-variable"
    PREDICTION_ERROR = "prediction-error"
    LEAST_SQUARES = "least-squares"


# Of the lags that may be asked for: allowed values, those to begin from, the largest step at once,
# and the step of a difference.
class _Range(NamedTuple):
    least: float
    most: float
    starts: tuple[float, ...]
    stride: float
    small: float


FREE_LAGS = {
    "delay": _Range(-0.2, 1.0, (0.0, 0.1, 0.2, 0.3, 0.4, 0.5), 0.05, 1e-3),
    "muscle_frequency": _Range(2.0, 200.0, (6.0, 12.0, 24.0, 48.0), 5.0, 1e-2),
}

_MOST_ITERATIONS = 30
_CLOSE = 1e-3  # of a standard error
_ORDER_CHOSEN = 5  # iterations
_KEPT = 8  # sets of lags whose regressors are remembered


@dataclass(frozen=True, eq=False)
class Parameters:
    """Coefficients of the structure's terms (k,), and the lags."""

    coefficients: Vector
    lags: Lags


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters with the covariance of coefficients and free lags, in this order.

    `modelled` is the torque by recorded signals, `residual` what it leaves of the recorded one, per
    ride, a value a block [N m]. `condition` is that of Z with columns of length 1, `strength` the
    Cragg-Donald statistic of the instruments (infinite where there are none).
    """

    parameters: Parameters
    covariance: Columns
    modelled: tuple[Vector, ...]
    residual: tuple[Vector, ...]
    noise: Vector
    condition: float
    strength: float
    converged: bool


class _Record(NamedTuple):
    """A ride ready for regression: torque and drift (constant and trend) a block.

    `known`: the regressors by recorded signals, for the lags that they were last asked for.
    """

    ride: Ride
    signals: Signals
    torque: Vector
    drift: Columns
    known: dict[Lags, Columns]


class Estimator:
    """Rides of one rider, the structure asked for, and which of its lags are free."""

    def __init__(
        self,
        rides: Sequence[Ride],
        structure: Structure,
        lags: Lags,
        free: Sequence[str] = (),
        *,
        from_bar: bool,
    ) -> None:
        self.structure, self._lags, self._free = structure, lags, tuple(free)
        self.records = [self._record(ride, from_bar) for ride in rides]
        self._bounds = [FREE_LAGS[name] for name in self._free]

    def _record(self, ride: Ride, from_bar: bool) -> _Record:
        first = settled(ride)
        measured = torque(ride, from_bar=from_bar)[first:]
        unknowns = len(self.structure.terms) + len(self._free) + 2
        if len(measured) < 20 * unknowns:
            left = "" if ride.fell is None else f" before the fall at {ride.fell:.2f} s"
            raise InputError(
                f"{ride.name}: {ride.duration:.2f} s{left}: too short for {unknowns - 2} gains; "
                f"at least {first * 0.02 + 0.4 * unknowns:.1f} s are needed"
            )
        if np.ptp(measured) < 1e-9:
            raise InputError(f"{ride.name}: the rider's torque never changes: nobody steers")
        trend = np.linspace(-1, 1, len(measured))
        drift = np.column_stack([np.ones_like(trend), trend])
        return _Record(ride, recorded(ride, self.structure), measured, drift, {})

    def estimate(self, method: Method) -> Estimate:
        """By a method: from the lags of the structure's source, or else from the best of a grid."""
        if method is not Method.LEAST_SQUARES:
            found = self._estimated(method, self._fitted(self._lags)[1])
            if found.converged or not self._free:
                return found
        return self._estimated(method, self._least_of_grid())

    def _estimated(self, method: Method, start: Parameters) -> Estimate:
        p, noise, converged = start, WHITE, False
        drift = [np.zeros(2) for _ in self.records]
        system = self._system(p, drift, noise, method)
        for iteration in range(_MOST_ITERATIONS):
            step = system.step()
            p, drift = self._moved(p, drift, step)
            if method is not Method.LEAST_SQUARES:
                noise = self._noise(p, drift, noise, step, first=iteration <= _ORDER_CHOSEN)
            system = self._system(p, drift, noise, method)
            # The residual's own colour is known from the second step on.
            if iteration > 1 and system.nearness(self._count) < _CLOSE:
                converged = True
                break
        residual = self._residuals(p, drift)
        return Estimate(
            parameters=p,
            covariance=system.covariance()[: self._count, : self._count],
            modelled=tuple(
                record.torque - e for record, e in zip(self.records, residual, strict=True)
            ),
            residual=tuple(residual),
            noise=noise,
            condition=system.condition(self._count),
            strength=(
                system.strength(self._count)
                if method is Method.INSTRUMENTAL_VARIABLE
                else float("inf")
            ),
            converged=converged,
        )

    @property
    def _count(self) -> int:
        return len(self.structure.terms) + len(self._free)

    def _noise(
        self, p: Parameters, drift: Sequence[Vector], noise: Vector, step: Vector, *, first: bool
    ) -> Vector:
        """The residual's autoregression; its order is chosen at first, and then held to settle."""
        steps_too = step[self._count + 2 * len(self.records) :]
        if not first and len(steps_too):
            return np.concatenate([WHITE, noise[1:] + steps_too])
        return autoregression(self._residuals(p, drift), None if first else len(noise) - 1)

    def _least_of_grid(self) -> Parameters:
        grid = product(*(bounds.starts for bounds in self._bounds))
        tried = (self._fitted(self._with_free(values)) for values in grid)
        return min(tried, key=lambda found: found[0])[1]

    def _with_free(self, values: Sequence[float]) -> Lags:
        return self._lags._replace(**dict(zip(self._free, values, strict=True)))

    def _fitted(self, lags: Lags) -> tuple[float, Parameters]:
        """The least squares for given lags, and the sum of squares that is left."""
        own = np.vstack([self._columns(record, record.signals, lags) for record in self.records])
        regressors = np.hstack([own, _diagonal([record.drift for record in self.records])])
        measured = np.concatenate([record.torque for record in self.records])
        solution, *_ = np.linalg.lstsq(regressors, measured, rcond=None)
        left = float(np.sum((measured - regressors @ solution) ** 2))
        return left, Parameters(solution[: len(self.structure.terms)], lags)

    def _columns(self, record: _Record, signals: Signals, lags: Lags) -> Columns:
        if signals is not record.signals:
            return columns(signals, self.structure, lags)[settled(record.ride) :]
        if record.known.get(lags) is None:
            found = columns(signals, self.structure, lags)[settled(record.ride) :]
            while len(record.known) > _KEPT:
                record.known.pop(next(iter(record.known)))
            record.known[lags] = found
        return record.known[lags]

    def _sensitivity(self, record: _Record, signals: Signals, p: Parameters) -> Columns:
        """∂(torque)/∂(coefficients, free lags): (blocks, count)."""
        found = [self._columns(record, signals, p.lags)]
        for name, bounds in zip(self._free, self._bounds, strict=True):
            value = getattr(p.lags, name)
            more, less = (
                self._columns(record, signals, p.lags._replace(**{name: value + change}))
                for change in (bounds.small, -bounds.small)
            )
            found.append(((more - less) @ p.coefficients / (2 * bounds.small))[:, None])
        return np.hstack(found)

    def _residuals(self, p: Parameters, drift: Sequence[Vector]) -> list[Vector]:
        return [
            record.torque
            - self._columns(record, record.signals, p.lags) @ p.coefficients
            - record.drift @ nu
            for record, nu in zip(self.records, drift, strict=True)
        ]

    def _system(
        self, p: Parameters, drift: Sequence[Vector], noise: Vector, method: Method
    ) -> System:
        gradients = [self._sensitivity(record, record.signals, p) for record in self.records]
        instruments = gradients
        if method is Method.INSTRUMENTAL_VARIABLE:
            instruments = [self._sensitivity(r, self._driven(r.ride, p), p) for r in self.records]
        residuals = self._residuals(p, drift)
        drifts = _diagonal([whitened(noise, record.drift) for record in self.records])
        if method is Method.PREDICTION_ERROR:
            # Here the noise's own coefficients are parameters too: their errors are the gains' too.
            past = np.vstack([before(len(noise) - 1, e) for e in residuals])
            drifts = np.hstack([drifts, -past])

        def stacked(blocks: Sequence[Columns]) -> Columns:
            return np.hstack([np.vstack([whitened(noise, block) for block in blocks]), drifts])

        return System(
            stacked(instruments),
            stacked(gradients),
            np.concatenate([whitened(noise, e) for e in residuals]),
        )

    def _driven(self, ride: Ride, p: Parameters) -> Signals:
        return Signals(simulated(ride, self.structure, p.coefficients, p.lags), ride.period)

    def _moved(
        self, p: Parameters, drift: Sequence[Vector], step: Vector
    ) -> tuple[Parameters, list[Vector]]:
        terms, count = len(self.structure.terms), self._count
        changed = {}
        for name, bounds, wanted in zip(self._free, self._bounds, step[terms:count], strict=True):
            value = getattr(p.lags, name) + np.clip(wanted, -bounds.stride, bounds.stride)
            changed[name] = float(np.clip(value, bounds.least, bounds.most))
        moved = Parameters(p.coefficients + step[:terms], p.lags._replace(**changed))
        rest = step[count : count + 2 * len(self.records)].reshape(-1, 2)
        return moved, [nu + more for nu, more in zip(drift, rest, strict=True)]


def _diagonal(blocks: Sequence[Columns]) -> Columns:
    """Blocks down the diagonal, zero elsewhere."""
    from scipy.linalg import block_diag

    return block_diag(*blocks)
