"""Structures of a rider whose gains can be identified: torque = Σ coefficient · filter · signal."""

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import unknown

Vector = NDArray[np.floating[Any]]

Through = Literal["eyes", "hands", "arms"]
"""How a signal becomes torque: seen, late (e^{-τs} G_nm); felt (G_nm); or at once, by the arms."""


class Term(NamedTuple):
    """One signal of the sum. Its coefficient counts positive as it stands in the sum."""

    signal: str
    through: Through


class Gain(NamedTuple):
    """A gain as its source names it, and its unit."""

    name: str
    unit: str


class Lags(NamedTuple):
    """Visual delay τ [s]; G_nm(s) = ω²/(s² + 2ζωs + ω²) with ω [rad/s], ζ."""

    delay: float
    muscle_frequency: float
    muscle_damping_ratio: float


class Structure(NamedTuple):
    """Terms, and a gain for each.

    A gain is its term's coefficient; that of arms is its negative; those of `nested` loops, from
    the inside out, are each coefficient over the one before. `lags` are its source's, held unless
    they are asked for; `free` are those that it asks for.
    """

    name: str
    source: str
    terms: tuple[Term, ...]
    gains: tuple[Gain, ...]
    lags: Lags
    free: tuple[str, ...] = ()
    nested: bool = False
    straight_only: bool = False

    def to_gains(self, coefficients: Vector) -> Vector:
        """The gains of the terms' coefficients (k,), in the order of `gains`."""
        arms = np.array([term.through == "arms" for term in self.terms])
        gains = np.where(arms, -coefficients, coefficients)
        if self.nested:
            brain = coefficients[~arms]
            gains[~arms] = np.concatenate([-brain[:1], brain[1:] / brain[:-1]])
        return gains


def structure(name: str, *, arms: bool = False) -> Structure:
    """A structure by name, with the passive arms beside it if asked. Raises InputError."""
    if name not in STRUCTURES:
        raise unknown("structure", name, STRUCTURES)
    found = STRUCTURES[name]
    return _with_arms(found) if arms else found


def _with_arms(brain: Structure) -> Structure:
    """T = brain - J δ̈ - b δ̇ - k δ: what the bar gets from brain and arms together."""
    return brain._replace(terms=brain.terms + _ARM_TERMS, gains=brain.gains + _ARM_GAINS)


_ARM_TERMS = tuple(Term(signal, "arms") for signal in ("steer_acceleration", "steer_rate", "steer"))
_ARM_GAINS = (
    Gain("arm_inertia", "kg m²"),
    Gain("arm_damping", "N m s/rad"),
    Gain("arm_stiffness", "N m/rad"),
)

_SCHWAB2013 = Structure(
    name="schwab2013",
    source="[S13]: T = G_nm (k_phi φ + k_phi_dot φ̇ + k_int ∫δ dt + k_delta_dot δ̇)",
    terms=(
        Term("roll", "eyes"),
        Term("roll_rate", "eyes"),
        Term("steer_integral", "hands"),
        Term("steer_rate", "hands"),
    ),
    gains=(
        Gain("k_phi", "N m/rad"),
        Gain("k_phi_dot", "N m s/rad"),
        Gain("k_int", "N m/(rad s)"),
        Gain("k_delta_dot", "N m s/rad"),
    ),
    lags=Lags(0.0, 2 * np.pi * 2.17, 0.5**0.5),
)

_ROLL_PD = Structure(
    name="roll-pd",
    source="T = G_nm e^{-τs} (k_phi φ + k_phi_dot φ̇), G_nm of [H12]",
    terms=(Term("roll", "eyes"), Term("roll_rate", "eyes")),
    gains=(Gain("k_phi", "N m/rad"), Gain("k_phi_dot", "N m s/rad")),
    lags=Lags(0.2, 30.0, 0.707),
    free=("delay",),
)


# U = k_δ(δ_c - δ), δ_c = k_φ̇(φ̇_c - φ̇), φ̇_c = k_φ(φ_c - φ), φ_c = k_ψ(ψ_c - ψ),
# ψ_c = k_y(y_c - y_q), multiplied out for y_c = 0: U = -k_δ δ - k_δ k_φ̇ φ̇ - k_δ k_φ̇ k_φ φ - ...
_HESS2012 = Structure(
    name="hess2012",
    source="[H12]: U = k_delta (k_phi_dot (k_phi (k_psi (k_y (0 - y_q) - ψ) - φ) - φ̇) - δ)",
    terms=(
        Term("steer", "hands"),
        Term("roll_rate", "eyes"),
        Term("roll", "eyes"),
        Term("heading", "eyes"),
        Term("front_y", "eyes"),
    ),
    gains=(
        Gain("k_delta", "N m/rad"),
        Gain("k_phi_dot", "s"),
        Gain("k_phi", "1/s"),
        Gain("k_psi", "1"),
        Gain("k_y", "rad/m"),
    ),
    lags=Lags(0.0, 30.0, 0.707),
    nested=True,
    straight_only=True,
)

STRUCTURES = {found.name: found for found in (_SCHWAB2013, _ROLL_PD, _HESS2012)}
