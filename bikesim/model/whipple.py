"""The linearised Whipple/Carvallo bicycle: its matrices from its parameters [M07, Appendix A]."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.parameters import BicycleParameters

Matrix = NDArray[np.float64]

# Far beyond any bicycle's; what lies beyond them cannot be computed with.
_LARGEST, _LEAST_INERTIA = 1e9, 1e-9


@dataclass(frozen=True, eq=False)
class Matrices:
    """M q̈ + v C1 q̇ + (g K0 + v² K2) q = (T_φ, T_δ), with q = (roll φ, steer δ) [M07 eq. 5.3].

    Each is 2 x 2 and read-only. M [kg m²], C1 [kg m], K0 [kg m], K2 [kg].
    Raises InputError if one is not finite or beyond ±1e9, or M is not symmetric and positive
    definite.
    """

    M: Matrix
    C1: Matrix
    K0: Matrix
    K2: Matrix

    def __post_init__(self) -> None:
        for name in ("M", "C1", "K0", "K2"):
            matrix = np.array(getattr(self, name), dtype=np.float64)
            if matrix.shape != (2, 2):
                raise InputError(f"matrix {name} has shape {matrix.shape}: must be 2 x 2")
            if not np.isfinite(matrix).all():
                raise InputError(f"matrix {name} = {matrix.tolist()}: must be finite")
            if np.abs(matrix).max() > _LARGEST:
                raise InputError(f"matrix {name} = {matrix.tolist()}: must be within ±{_LARGEST:g}")
            matrix.flags.writeable = False
            object.__setattr__(self, name, matrix)
        if not np.isclose(self.M[0, 1], self.M[1, 0], rtol=1e-9, atol=0):
            raise InputError(f"mass matrix M = {self.M.tolist()}: must be symmetric")
        if self.M[0, 0] <= 0 or np.linalg.det(self.M) <= 0:
            raise InputError(f"mass matrix M = {self.M.tolist()}: must be positive definite")
        if min(self.M[0, 0], self.M[1, 1]) < _LEAST_INERTIA:
            raise InputError(
                f"mass matrix M = {self.M.tolist()}: must have at least {_LEAST_INERTIA:g} "
                "on its diagonal"
            )

    def damping(self, speed: float) -> Matrix:
        """C = v C1 [N m s/rad], 2 x 2, for a forward speed v [m/s]."""
        return speed * self.C1

    def stiffness(self, speed: float, gravity: float) -> Matrix:
        """K = g K0 + v² K2 [N m/rad], 2 x 2, for v [m/s] and g [m/s²]."""
        return gravity * self.K0 + speed**2 * self.K2


def whipple_matrices(p: BicycleParameters) -> Matrices:
    """The matrices of [M07, eq. A1-A26]; symbols as there. Raises InputError as `Matrices` does."""
    sin, cos = np.sin(p.lam), np.cos(p.lam)
    # The whole bicycle (T).
    m_T = p.mR + p.mB + p.mH + p.mF
    x_T = (p.xB * p.mB + p.xH * p.mH + p.w * p.mF) / m_T
    z_T = (-p.rR * p.mR + p.zB * p.mB + p.zH * p.mH - p.rF * p.mF) / m_T
    I_Txx = (
        p.IRxx + p.IBxx + p.IHxx + p.IFxx
        + p.mR * p.rR**2 + p.mB * p.zB**2 + p.mH * p.zH**2 + p.mF * p.rF**2
    )  # fmt: skip
    I_Txz = p.IBxz + p.IHxz - p.mB * p.xB * p.zB - p.mH * p.xH * p.zH + p.mF * p.w * p.rF
    I_Tzz = (
        p.IRxx + p.IBzz + p.IHzz + p.IFxx + p.mB * p.xB**2 + p.mH * p.xH**2 + p.mF * p.w**2
    )  # fmt: skip
    # The front assembly (A) and its inertia about the steer axis (λ).
    m_A = p.mH + p.mF
    x_A = (p.xH * p.mH + p.w * p.mF) / m_A
    z_A = (p.zH * p.mH - p.rF * p.mF) / m_A
    I_Axx = p.IHxx + p.IFxx + p.mH * (p.zH - z_A) ** 2 + p.mF * (p.rF + z_A) ** 2
    I_Axz = p.IHxz - p.mH * (p.xH - x_A) * (p.zH - z_A) + p.mF * (p.w - x_A) * (p.rF + z_A)
    I_Azz = p.IHzz + p.IFxx + p.mH * (p.xH - x_A) ** 2 + p.mF * (p.w - x_A) ** 2
    u_A = (x_A - p.w - p.c) * cos - z_A * sin
    I_All = m_A * u_A**2 + I_Axx * sin**2 + 2 * I_Axz * sin * cos + I_Azz * cos**2
    I_Alx = -m_A * u_A * z_A + I_Axx * sin + I_Axz * cos
    I_Alz = m_A * u_A * x_A + I_Axz * sin + I_Azz * cos
    # Trail ratio, gyroscopic and static moment coefficients.
    mu = p.c / p.w * cos
    S_R, S_F = p.IRyy / p.rR, p.IFyy / p.rF
    S_T = S_R + S_F
    S_A = m_A * u_A + mu * m_T * x_T

    M_pd = I_Alx + mu * I_Txz
    return Matrices(
        M=np.array([[I_Txx, M_pd], [M_pd, I_All + 2 * mu * I_Alz + mu**2 * I_Tzz]]),
        C1=np.array(
            [
                [0.0, mu * S_T + S_F * cos + I_Txz / p.w * cos - mu * m_T * z_T],
                [-(mu * S_T + S_F * cos), I_Alz / p.w * cos + mu * (S_A + I_Tzz / p.w * cos)],
            ]
        ),
        K0=np.array([[m_T * z_T, -S_A], [-S_A, -S_A * sin]]),
        K2=np.array([[0.0, (S_T - m_T * z_T) / p.w * cos], [0.0, (S_A + S_F * sin) / p.w * cos]]),
    )
