"""A rider as a linear state space, and the loop that he closes with a bicycle or simulator.

For analysis in continuous time: noise, sampling and limits are left out. What a rider perceives is
y = (φ, δ, φ̇, δ̇), roll and steer and their rates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.model.whipple import Matrix
from bikesim.rider.base import Arms
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS, IdentifiedRun
from bikesim.rider.settings import RiderSettings, identified_run

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


def linear_rider(settings: RiderSettings) -> LinearRider:
    """The linear part of a rider of these settings: hands-off, roll PD, or identified."""
    if settings.name == "hands-off":
        return LinearRider(np.zeros((0, 0)), np.zeros((0, 4)), np.zeros(0), Arms())
    muscle = _figure(settings.muscle_frequency), _figure(settings.muscle_damping_ratio)
    arms = Arms(
        _figure(settings.arm_inertia),
        _figure(settings.arm_damping),
        _figure(settings.arm_stiffness),
    )
    number = identified_run(settings.name)
    if number is not None:
        gains = next(run for run in IDENTIFIED_RUNS if run.run == number)
        return _identified(gains, *muscle, arms)
    gains = np.array([_figure(settings.roll_gain), 0.0, _figure(settings.roll_rate_gain), 0.0])
    return _roll_pd(gains, _figure(settings.visual_delay), *muscle, arms)


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


def _roll_pd(
    gains: NDArray[np.float64], delay: float, frequency: float, ratio: float, arms: Arms
) -> LinearRider:
    """States: those of the delay line, then T_δ and its rate."""
    muscle = _muscle(frequency, ratio)
    if delay == 0:
        return LinearRider(muscle, _driven(frequency, gains), np.array([1.0, 0.0]), arms)
    line, entry = delay_state_space(delay)
    order = len(line)
    seen = np.ones(order)
    A = np.block([[line, np.zeros((order, 2))], [_driven(frequency, seen), muscle]])
    B = np.vstack([entry @ gains[None, :], np.zeros((2, 4))])
    return LinearRider(A, B, np.array([*np.zeros(order), 1.0, 0.0]), arms)


def _identified(gains: IdentifiedRun, frequency: float, ratio: float, arms: Arms) -> LinearRider:
    """States: ∫δ dt, then T_δ and its rate."""
    felt = np.array([gains.roll, 0.0, gains.roll_rate, gains.steer_rate])
    A = np.zeros((3, 3))
    A[1:, :1] = _driven(frequency, np.array([gains.steer_integral]))
    A[1:, 1:] = _muscle(frequency, ratio)
    B = np.vstack([[0.0, 1.0, 0.0, 0.0], _driven(frequency, felt)])
    return LinearRider(A, B, np.array([0.0, 1.0, 0.0]), arms)


def _muscle(frequency: float, ratio: float) -> Matrix:
    """G_nm(s) = ω² / (s² + 2 ζ ω s + ω²) on (T_δ, Ṫ_δ)."""
    return np.array([[0.0, 1.0], [-(frequency**2), -2 * ratio * frequency]])


def _driven(frequency: float, gains: NDArray[np.float64]) -> Matrix:
    """How what is intended, gains · signals, enters the muscle's two states."""
    return np.vstack([np.zeros_like(gains), frequency**2 * gains])


def _figure(value: float | None) -> float:
    assert value is not None, "settings must be resolved"
    return value
