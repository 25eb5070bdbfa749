"""Eigenvalues of a bicycle or simulator, its modes by name, and the speeds where they change."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.model.whipple import Matrix


class Modes(NamedTuple):
    """The four eigenvalues [1/s] by the names of [M07]; `weave` is two of them.

    Where weave is a complex pair the one with positive imaginary part comes first; where it is
    two real numbers the smaller comes first.
    """

    castering: complex
    capsize: complex
    weave: tuple[complex, complex]

    def all(self) -> tuple[complex, complex, complex, complex]:
        """Castering, capsize, weave, weave."""
        return (self.castering, self.capsize, *self.weave)


def eigenvalues(mass: Matrix, damping: Matrix, stiffness: Matrix) -> np.ndarray:
    """The four s [1/s] with det(s² mass + s damping + stiffness) = 0, complex, shape (4,).

    Each matrix is 2 x 2; the mass matrix need not be symmetric (eq. 7 is not).
    """
    state = np.zeros((4, 4))
    state[:2, 2:] = np.eye(2)
    state[2:, :2] = -np.linalg.solve(mass, stiffness)
    state[2:, 2:] = -np.linalg.solve(mass, damping)
    return np.linalg.eigvals(state).astype(complex)


def name_modes(values: np.ndarray) -> Modes:
    """Name four eigenvalues [1/s] by their place in the plane, not by following them in speed.

    Castering is the most stable. A complex pair is the weave, the two real ones castering and
    capsize; but a pair that is more stable than both real ones is castering and capsize met, and
    the real ones are the weave that is not born yet. Four real ones, as at low speed: weave is the
    two least stable, of which the pair is born. Two pairs: weave is the less stable pair. Naming
    by place survives double roots and zeros, where following a root from speed to speed must guess.
    """
    in_order = sorted(values, key=lambda s: (s.real, s.imag))
    pairs = [s for s in in_order if s.imag > 0]
    if len(pairs) == 1:
        real = [s for s in in_order if s.imag == 0]
        if pairs[0].real < real[0].real:
            return Modes(pairs[0], pairs[0].conjugate(), (real[0], real[1]))
        return Modes(real[0], real[1], (pairs[0], pairs[0].conjugate()))
    if len(pairs) == 2:
        stable, weave = pairs
        return Modes(stable, stable.conjugate(), (weave, weave.conjugate()))
    return Modes(in_order[0], in_order[1], (in_order[2], in_order[3]))


def bicycle_modes(bicycle: Bicycle, speed: float) -> Modes:
    """The modes of the bicycle itself, hands off, at a forward speed [m/s]."""
    m = bicycle.matrices
    return name_modes(eigenvalues(m.M, m.damping(speed), m.stiffness(speed, bicycle.gravity)))


def simulator_modes(
    bicycle: Bicycle, law: Law, speed: float, inertia: float | None = None
) -> Modes:
    """The modes of the simulator, hands off (eq. 7), in continuous time.

    `inertia` [kg m²] about the rig's steer axis: by default what the law asks for.
    """
    return name_modes(eigenvalues(*simulator_matrices(bicycle, law, speed, inertia)))


class StabilityLimits(NamedTuple):
    """Speeds [m/s] between which the hands-off bicycle is self-stable; None where there is none.

    `weave`: the lowest speed from which the weave is stable. `capsize`: the speed at which a
    real eigenvalue passes zero.
    """

    weave: float | None
    capsize: float | None


def stability_limits(
    bicycle: Bicycle, law: Law | None = None, inertia: float | None = None
) -> StabilityLimits:
    """Weave and capsize speed of the bicycle, or of its simulator under `law`, hands off.

    The coefficients of the characteristic polynomial are polynomials in the speed, so both are
    roots of a polynomial: the weave speed of the third Hurwitz determinant, the capsize speed of
    det K. No range has to be scanned.
    """
    if law is None:
        mass = bicycle.matrices.M
    else:
        mass = simulator_matrices(bicycle, law, 0.0, inertia)[0]
    second_row = 0.0 if law is Law.OFF else 1.0
    a0, a1, a2, a3, a4 = _characteristic_polynomial(bicycle, mass, second_row)
    hurwitz = a3 * a2 * a1 - a4 * a1 * a1 - a3 * a3 * a0

    def modes(speed: float) -> Modes:
        if law is None:
            return bicycle_modes(bicycle, speed)
        return simulator_modes(bicycle, law, speed, inertia)

    def weave_becomes_stable(speed: float) -> bool:
        before, after = modes(speed * (1 - 1e-6)).weave[0], modes(speed * (1 + 1e-6)).weave[0]
        return after.imag > 0 and before.real > 0 > after.real

    def capsize_is_zero(speed: float) -> bool:
        found = modes(speed)
        return abs(found.capsize) == min(abs(s) for s in found.all())

    return StabilityLimits(
        weave=next(filter(weave_becomes_stable, _positive_roots(hurwitz)), None),
        capsize=next(filter(capsize_is_zero, _positive_roots(a0)), None),
    )


def _characteristic_polynomial(
    bicycle: Bicycle, mass: Matrix, second_row: float
) -> tuple[Polynomial, ...]:
    """a0..a4 of a4 s⁴ + ... + a0 = det(s² mass + s C + K), each a polynomial in the speed."""
    m = bicycle.matrices
    rows = np.array([[1.0], [second_row]])

    def entries(*by_power: Matrix) -> list[list[Polynomial]]:
        return [[Polynomial([matrix[i, j] for matrix in by_power]) for j in (0, 1)] for i in (0, 1)]

    nothing = np.zeros((2, 2))
    M = entries(mass)
    C = entries(nothing, rows * m.C1)
    K = entries(bicycle.gravity * rows * m.K0, nothing, rows * m.K2)

    def mixed(A: list[list[Polynomial]], B: list[list[Polynomial]]) -> Polynomial:
        return A[0][0] * B[1][1] + A[1][1] * B[0][0] - A[0][1] * B[1][0] - A[1][0] * B[0][1]

    return (
        mixed(K, K) / 2,
        mixed(C, K),
        mixed(M, K) + mixed(C, C) / 2,
        mixed(M, C),
        mixed(M, M) / 2,
    )


def _positive_roots(polynomial: Polynomial) -> list[float]:
    """The real roots above zero, ascending, each polished by Newton's method."""
    if np.max(np.abs(polynomial.coef)) == 0:
        return []
    slope = polynomial.deriv()
    found = []
    for root in polynomial.trim().roots():
        if root.real <= 1e-6 or abs(root.imag) > 1e-6 * abs(root):
            continue
        speed = float(root.real)
        for _ in range(3):
            if (gradient := slope(speed)) != 0:
                speed -= float(polynomial(speed) / gradient)
        found.append(speed)
    return sorted(found)
