"""Exact integration of the roll equation over one step of linearly interpolated input."""

from functools import lru_cache
from typing import Any

# Terms of the exponential's series: with |λ h| ≤ 1 the first one left out is below 1e-18.
_TERMS = 20
# Enough for any step that is not infinite by mistake.
_HALVINGS = 60

Transition = tuple[Any, ...]


def transition(step: float, stiffness: Any, damping: Any) -> Transition:
    """First-order-hold matrices of ż = A z + u, A = [[0, 1], [-stiffness, -damping]].

    z(h) = Φ z(0) + Ψ0 u(0) + Ψ1 u(h) for u linear over the step h [s], where Φ = φ0(A h),
    Ψ1 = h φ2(A h), Ψ0 = h φ1(A h) - Ψ1, and φk(Z) = Σ Zⁿ/(n+k)!. Stiffness [1/s²] and damping
    [1/s] are per unit of inertia; floats, or arrays for a batch. Gives the twelve entries, row by
    row, of Φ, Ψ0, Ψ1. Exact to rounding: where |λ| h > 1 for an eigenvalue λ of A (more than
    0.16 s for a bicycle) the step is doubled from shorter ones.
    """
    try:
        return _cached(step, stiffness, damping)
    except TypeError:  # arrays are not hashable
        return _transition(step, stiffness, damping)


def _transition(h: float, k: float, c: float, halvings: int = _HALVINGS) -> Transition:
    if halvings and _is_long(h, k, c):
        return _doubled(_transition(0.5 * h, k, c, halvings - 1))
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


def _matrix(a: Any, b: Any, h: float, k: Any, c: Any) -> Transition:
    """The entries of a I + b h A."""
    return a, b * h, -b * h * k, a - b * h * c


def _is_long(h: float, k: float, c: float) -> bool:
    """Whether |λ| h may exceed 1, by |λ| ≤ |c| + √|k|; for a batch, anywhere in it."""
    long = (abs(c) * h > 0.5) | (abs(k) * h * h > 0.25)
    return long if isinstance(long, bool) else bool(long.any())


def _doubled(half: Transition) -> Transition:
    """The transition over 2 h from that over h: the input at h is the mean of its two ends."""
    phi, before, after = half[0:4], half[4:8], half[8:12]
    middle = tuple(0.5 * (x + y) for x, y in zip(_product(phi, after), before, strict=True))
    first = (x + y for x, y in zip(_product(phi, before), middle, strict=True))
    last = (x + y for x, y in zip(middle, after, strict=True))
    return (*_product(phi, phi), *first, *last)


def _product(P: tuple[float, ...], Q: tuple[float, ...]) -> tuple[float, ...]:
    (p11, p12, p21, p22), (q11, q12, q21, q22) = P, Q
    return (
        p11 * q11 + p12 * q21, p11 * q12 + p12 * q22,
        p21 * q11 + p22 * q21, p21 * q12 + p22 * q22,
    )  # fmt: skip


# By type too: what was worked out in NumPy scalars must not come back to a loop of floats.
_cached = lru_cache(maxsize=4096, typed=True)(_transition)
