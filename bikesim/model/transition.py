"""Exact integration of the roll equation over one step of linearly interpolated input."""

from functools import lru_cache

# Terms of the exponential's series: with |λ h| ≤ 1 the first one left out is below 1e-17.
_TERMS = 18

Transition = tuple[float, ...]


def transition(step: float, stiffness: float, damping: float) -> Transition:
    """First-order-hold matrices of ż = A z + u, A = [[0, 1], [-stiffness, -damping]].

    z(h) = Φ z(0) + Ψ0 u(0) + Ψ1 u(h) for u linear over the step h [s], where Φ = φ0(A h),
    Ψ1 = h φ2(A h), Ψ0 = h φ1(A h) - Ψ1, and φk(Z) = Σ Zⁿ/(n+k)!. Stiffness [1/s²] and damping
    [1/s] are per unit of inertia; floats, or arrays for a batch. Gives the twelve entries, row by
    row, of Φ, Ψ0, Ψ1. Exact to rounding while |λ| h ≤ 1 for both eigenvalues λ of A: steps up
    to 0.3 s for a bicycle.
    """
    try:
        return _cached(step, stiffness, damping)
    except TypeError:  # arrays are not hashable
        return _transition(step, stiffness, damping)


def _transition(h: float, k: float, c: float) -> Transition:
    # Zⁿ = a I + b Z for a 2 x 2 matrix (Cayley-Hamilton), so the series is one of scalars and
    # the same lines serve floats and arrays. Z = A h has trace -c h and determinant k h².
    trace, determinant = -c * h, k * h * h
    a, b = 1.0 + 0.0 * determinant, 0.0 * determinant
    a0, b0, a1, b1, a2, b2 = a, b, a, b, 0.5 * a, b
    factorial = 1.0
    for n in range(1, _TERMS):
        a, b = -determinant * b, a + trace * b
        factorial *= n
        a0, b0 = a0 + a / factorial, b0 + b / factorial
        a1, b1 = a1 + a / (factorial * (n + 1)), b1 + b / (factorial * (n + 1))
        last = factorial * (n + 1) * (n + 2)
        a2, b2 = a2 + a / last, b2 + b / last
    return (
        *_matrix(a0, b0, h, k, c),
        *_matrix((a1 - a2) * h, (b1 - b2) * h, h, k, c),
        *_matrix(a2 * h, b2 * h, h, k, c),
    )


def _matrix(a: float, b: float, h: float, k: float, c: float) -> tuple[float, ...]:
    """The entries of a I + b h A."""
    return a, b * h, -b * h * k, a - b * h * c


_cached = lru_cache(maxsize=4096)(_transition)
