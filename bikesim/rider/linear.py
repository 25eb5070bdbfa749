"""A rider as a linear state space, and the loop that he closes with a bicycle or simulator.

For analysis in continuous time: noise, sampling and limits are left out. What a rider perceives is
y = (φ, δ, φ̇, δ̇), roll and steer and their rates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.model.whipple import Matrix
from bikesim.rider.base import Arms
from bikesim.rider.settings import RiderSettings

# Order of the Padé approximation of the visual delay: roots with |s| < 8 rad/s of riders with up to
# 0.56 s of it (the longest published) are within 1e-5 1/s of those of the exact delay.
DELAY_ORDER = 8


class LinearRider(NamedTuple):
    """ẋ = A x + B y, T_δ = C x, y = (φ, δ, φ̇, δ̇): shapes (n, n), (n, 4), (n,). SI, radians.

    The passive `arms` are not in A; they belong to the bar.
    """

    A: Matrix
    B: Matrix
    C: NDArray[np.float64]
    arms: Arms


class _Pathway(NamedTuple):
    """What a sense contributes to the intended torque: gains on y, and on ∫δ dt, after a delay."""

    gains: NDArray[np.float64]
    steer_integral: float
    delay: float


_LINEAR = "human, pd, hands-off, schwab2013-RUN"


def linear_rider(settings: RiderSettings) -> LinearRider:
    """The linear part of a rider who is a gain on each signal, and hands-off; as he begins.

    Without noise, limit and changes of grip. Raises InputError for a rider of another kind, or
    one without muscles.
    """
    s = settings
    if s.name == "hands-off":
        return LinearRider(np.zeros((0, 0)), np.zeros((0, 4)), np.zeros(0), Arms())
    if s.roll_gain is None:
        raise InputError(f"rider {s.name}: has no linear form here; those who have: {_LINEAR}")
    if s.muscle_frequency is None:
        raise InputError(f"rider {s.name}: has no linear form without rider.muscle_frequency")
    muscle = s.muscle_frequency, _known(s.muscle_damping_ratio)
    arms = Arms(_known(s.arm_inertia), _known(s.arm_damping), _known(s.arm_stiffness))
    return _assembled(_pathways(s), *muscle, arms)


def _pathways(s: RiderSettings) -> list[_Pathway]:
    """By eyes, balance organs and hands; those that contribute."""
    roll, roll_rate, share = (
        _known(s.roll_gain),
        _known(s.roll_rate_gain),
        _known(s.vestibular_share),
    )
    seen = np.array([roll, 0.0, (1 - share) * roll_rate, 0.0])
    turned = np.array([0.0, 0.0, share * roll_rate, 0.0])
    felt = np.array([0.0, 0.0, 0.0, s.steer_rate_gain or 0.0])
    pathways = [_Pathway(seen, 0.0, _known(s.visual_delay))]
    if share:
        pathways.append(_Pathway(turned, 0.0, _known(s.vestibular_delay)))
    if s.steer_rate_gain is not None:
        steer_integral = s.steer_integral_gain or 0.0
        pathways.append(_Pathway(felt, steer_integral, _known(s.proprioceptive_delay)))
    return pathways


def closed_loop(
    bicycle: Bicycle,
    speed: float,
    rider: LinearRider,
    *,
    law: Law | None,
    inertia: float | None = None,
) -> Matrix:
    """The state matrix of bicycle and rider together, state (φ, δ, φ̇, δ̇, rider's), (4+n, 4+n).

    `law` is that of the simulator, None the bicycle itself; `inertia` I_δ [kg m²] of the rig
    without arms, by default what the law asks for. The arms act between bar and trunk.
    """
    mass, damping, stiffness = _open_loop(bicycle, speed, law, inertia)
    arms = rider.arms
    on_bar = np.diag([0.0, 1.0])
    mass = mass + arms.inertia * on_bar
    damping = damping + arms.damping * on_bar
    stiffness = stiffness + arms.stiffness * on_bar
    order = len(rider.C)
    torque = np.linalg.solve(mass, np.array([0.0, 1.0]))
    return np.block(
        [
            [np.zeros((2, 2)), np.eye(2), np.zeros((2, order))],
            [
                -np.linalg.solve(mass, stiffness),
                -np.linalg.solve(mass, damping),
                np.outer(torque, rider.C),
            ],
            [rider.B, rider.A],
        ]
    )


def spectral_abscissa(matrix: Matrix) -> float:
    """The largest real part of the eigenvalues [1/s]: the growth rate; stable below zero."""
    return float(np.linalg.eigvals(matrix).real.max())


def delay_state_space(delay: float, order: int = DELAY_ORDER) -> tuple[Matrix, Matrix]:
    """A and B of the Padé approximant [order-1/order] of e^{-sτ}; its output is the sum of states.

    In the basis of shifted Legendre polynomials on the last τ seconds, which keeps the matrices
    well conditioned [Voelker & Eliasmith 2018, eq. 5]. `delay` τ [s] above 0.
    """
    i = np.arange(order)
    later = i[:, None] < i[None, :]
    alternating = np.where((i[:, None] - i[None, :]) % 2 == 0, -1.0, 1.0)
    scale = (2 * i + 1) / delay
    return np.where(later, -1.0, alternating) * scale[:, None], (scale * (-1.0) ** i)[:, None]


def _open_loop(
    bicycle: Bicycle, speed: float, law: Law | None, inertia: float | None
) -> tuple[Matrix, Matrix, Matrix]:
    if law is not None:
        return simulator_matrices(bicycle, law, speed, inertia)
    m = bicycle.matrices
    return m.M, m.damping(speed), m.stiffness(speed, bicycle.gravity)


def _assembled(pathways: list[_Pathway], frequency: float, ratio: float, arms: Arms) -> LinearRider:
    """States: ∫δ dt where it has a gain, then each pathway's delay line, then T_δ and its rate."""
    integral = any(one.steer_integral for one in pathways)
    orders = [DELAY_ORDER if one.delay else 0 for one in pathways]
    order = int(integral) + sum(orders) + 2
    A, B = np.zeros((order, order)), np.zeros((order, 4))
    if integral:
        B[0, 1] = 1.0
    A[-2:, -2:] = _muscle(frequency, ratio)
    first = int(integral)
    for pathway, lines in zip(pathways, orders, strict=True):
        last = first + lines
        entry = np.array([0.0, frequency**2])[:, None]
        rows = slice(-2, None)
        if lines:
            A[first:last, first:last], entry_of_line = delay_state_space(pathway.delay)
            A[-2:, first:last] = entry
            entry, rows = entry_of_line, slice(first, last)
        B[rows] += entry * pathway.gains
        if pathway.steer_integral:
            A[rows, :1] += entry * pathway.steer_integral
        first = last
    return LinearRider(A, B, np.array([*np.zeros(order - 2), 1.0, 0.0]), arms)


def _muscle(frequency: float, ratio: float) -> Matrix:
    """G_nm(s) = ω² / (s² + 2 ζ ω s + ω²) on (T_δ, Ṫ_δ)."""
    return np.array([[0.0, 1.0], [-(frequency**2), -2 * ratio * frequency]])


def _known(value: float | None) -> float:
    assert value is not None, "settings must be resolved"
    return value
