"""One step of Gauss and Newton for Zᵀ e(p) = 0, and what Z and Ψ say of its answer."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.identify.structure import Vector

Columns = NDArray[np.floating[Any]]


class System(NamedTuple):
    """Zᵀ Ψ Δp = Zᵀ e, all whitened; drift in the last columns of Z and Ψ."""

    instruments: Columns
    gradient: Columns
    residual: Vector

    def step(self) -> Vector:
        z = self.instruments
        try:
            return np.linalg.solve(z.T @ self.gradient, z.T @ self.residual)
        except np.linalg.LinAlgError:
            raise InputError(
                "the records cannot tell the gains apart at all: nothing excites the rider, "
                "or some of the signals are the same"
            ) from None

    def covariance(self) -> Columns:
        """σ² (ZᵀΨ)⁻¹ ZᵀZ (ΨᵀZ)⁻¹, for a residual that is white."""
        z = self.instruments
        inverse = np.linalg.inv(z.T @ self.gradient)
        variance = self.residual @ self.residual / (len(self.residual) - z.shape[1])
        return variance * inverse @ (z.T @ z) @ inverse.T

    def nearness(self, count: int) -> float:
        """The next step in standard errors, the largest."""
        error = np.sqrt(np.diag(self.covariance())[:count])
        return float(np.max(np.abs(self.step()[:count]) / np.maximum(error, 1e-300)))

    def condition(self, count: int) -> float:
        own = self._without_drift(self.instruments, count)
        values = np.linalg.svd(own / np.linalg.norm(own, axis=0), compute_uv=False)
        return float(values[0] / max(values[-1], 1e-300))

    def strength(self, count: int) -> float:
        """The least eigenvalue of the first stage's F matrix [Cragg & Donald 1993]."""
        from scipy.linalg import eigh

        z = self._without_drift(self.instruments, count)
        x = self._without_drift(self.gradient, count)
        explained = z @ np.linalg.lstsq(z, x, rcond=None)[0]
        left = x - explained
        scale = np.linalg.norm(x, axis=0)
        explained, left = explained / scale, left / scale
        error = left.T @ left / (len(x) - count) + 1e-18 * np.eye(count)
        return float(eigh(explained.T @ explained, error, eigvals_only=True)[0] / count)

    def _without_drift(self, values: Columns, count: int) -> Columns:
        own, drift = values[:, :count], values[:, count:]
        return own - drift @ np.linalg.lstsq(drift, own, rcond=None)[0]
