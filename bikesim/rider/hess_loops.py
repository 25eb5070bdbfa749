"""The loops of Hess's rider around a bicycle or simulator, in continuous time, for analysis.

State (φ, δ, φ̇, δ̇, ψ, y_p, T_δ, Ṫ_δ), of bicycle, path and muscle; without preview and path filter,
which lie outside the loops. The feedback signals are δ, φ̇, φ, ψ, y_q, from the inner loop to the
outer.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.whipple import Matrix
from bikesim.rider.base import Arms
from bikesim.rider.hess_gains import Gains
from bikesim.rider.linear import LinearRider, closed_loop

MUSCLE = (30.0, 0.707)  # rad/s and damping ratio [H12]
_STEER, _ROLL_RATE, _ROLL = range(3)
# Of |Re s| / |s|, below which a double-precision eigenvalue is taken to lie on the axis.
_ON_AXIS = 1e-5


class Crossovers(NamedTuple):
    """Where each loop's gain falls through 1 [rad/s], those inside it closed; NaN: nowhere."""

    steer: float
    roll_rate: float
    roll: float
    heading: float
    lateral: float


def linear_hess(
    bicycle: Bicycle,
    gains: Gains,
    speed: float,
    *,
    muscle: tuple[float, float] = MUSCLE,
    arms: Arms | None = None,
) -> LinearRider:
    """The rider for `closed_loop`, at a speed [m/s], on the straight line; states ψ, y_p, T_δ, Ṫ_δ.

    `muscle`: natural frequency [rad/s] and damping ratio.
    """
    rider = _passive(bicycle, speed, muscle, arms or Arms())
    total = np.cumprod(gains) @ _signals(bicycle)
    drive = muscle[0] ** 2 * total
    rider.B[3] -= drive[:4]
    rider.A[3, :2] -= drive[4:6]
    return rider


def crossovers(
    bicycle: Bicycle,
    gains: Gains,
    speed: float,
    law: Law | None = None,
    *,
    inertia: float | None = None,
    muscle: tuple[float, float] = MUSCLE,
    arms: Arms | None = None,
) -> Crossovers:
    """The loops' crossover frequencies, on the bicycle (`law` None) or the simulator under a law.

    Each loop is cut where its command enters, those inside it closed, those around it open; the
    first frequency at which its gain falls through 1 (of the steer loop, which dips below 1 at the
    weave mode of a fast bicycle, the last). [H12] has 2, 1 and 0.5 rad/s for the outer three.
    `inertia` [kg m²] as in `closed_loop`.
    """
    A, drive, signals = _cut(bicycle, speed, law, inertia, muscle, arms)
    frequencies = []
    for gain, signal in zip(gains, signals, strict=True):
        drive = drive * gain
        falls = _falls(A, drive, signal) or [math.nan]
        frequencies.append(falls[0] if frequencies else falls[-1])
        A = A - np.outer(drive, signal)
    return Crossovers(*frequencies)


def handling_quality(
    bicycle: Bicycle,
    gains: Gains,
    speed: float,
    frequencies: NDArray[np.float64],
    law: Law | None = None,
    *,
    inertia: float | None = None,
    muscle: tuple[float, float] = MUSCLE,
    arms: Arms | None = None,
) -> NDArray[np.float64]:
    """Hess's handling-quality metric at `frequencies` [rad/s], shape (n,), without unit.

    HQM(ω) = |U_M / φ_c| / |k_φ| · |20² / (jω + 20)²| with the three inner loops closed and U_M =
    φ̇ + δ / k_φ̇, all that the rate loop feeds back [H12; Hess 2006, Control Eng. Practice; Moore,
    Hubbard & Hess 2016]. Lower is better: its peak is below 5 in level 1 (little compensation
    required), from 5 to 8 in level 2 (moderate), above in level 3. Made for a roll loop that
    crosses over at 2 rad/s, and only for a closed loop that is stable.
    """
    A, drive, signals = _cut(bicycle, speed, law, inertia, muscle, arms)
    inner = np.cumprod(gains[:3])
    A = A - np.outer(drive, inner @ signals[:3])
    rate = signals[_ROLL_RATE] + signals[_STEER] / gains.roll_rate
    s = 1j * np.asarray(frequencies, dtype=float)
    response = _response(A, drive * inner[_ROLL], rate, s)
    return np.abs(response / gains.roll * 400 / (s + 20) ** 2)


def _passive(
    bicycle: Bicycle, speed: float, muscle: tuple[float, float], arms: Arms
) -> LinearRider:
    """The rider's states without feedback: eq. 8 linearised, and the muscle at rest."""
    frequency, ratio = muscle
    turn = math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase
    A, B = np.zeros((4, 4)), np.zeros((4, 4))
    A[1, 0] = speed
    A[2, 3] = 1.0
    A[3, 2:] = -(frequency**2), -2 * ratio * frequency
    B[0] = 0.0, speed * turn, 0.0, bicycle.trail * turn
    return LinearRider(A, B, np.array([0.0, 0.0, 1.0, 0.0]), arms)


def _signals(bicycle: Bicycle) -> Matrix:
    """δ, φ̇, φ, ψ, y_q from the state, shape (5, 8)."""
    signals = np.zeros((5, 8))
    for loop, state in enumerate((1, 2, 0, 4, 5)):
        signals[loop, state] = 1.0
    signals[4, 4] = bicycle.wheelbase
    signals[4, 1] = -bicycle.trail * math.cos(bicycle.steer_axis_tilt)
    return signals


def _cut(
    bicycle: Bicycle,
    speed: float,
    law: Law | None,
    inertia: float | None,
    muscle: tuple[float, float],
    arms: Arms | None,
) -> tuple[Matrix, NDArray[np.float64], Matrix]:
    """All loops open: A (8, 8), how the muscle is driven (8,), the signals (5, 8)."""
    passive = _passive(bicycle, speed, muscle, arms or Arms())
    A = closed_loop(bicycle, speed, passive, law=law, inertia=inertia)
    drive = np.zeros(8)
    drive[7] = muscle[0] ** 2
    return A, drive, _signals(bicycle)


def _falls(A: Matrix, B: NDArray[np.float64], C: NDArray[np.float64]) -> list[float]:
    """Each ω at which |C (jω - A)⁻¹ B| falls through 1, rising.

    It is 1 where jω is an eigenvalue of the Hamiltonian matrix [[A, B Bᵀ], [-Cᵀ C, -Aᵀ]].
    """
    roots = np.linalg.eigvals(np.block([[A, np.outer(B, B)], [-np.outer(C, C), -A.T]]))
    on_axis = (roots.imag > 0) & (np.abs(roots.real) < _ON_AXIS * np.abs(roots))
    frequencies = np.sort(roots[on_axis].imag)
    before, after = (np.abs(_response(A, B, C, 1j * frequencies * x)) for x in (0.999, 1.001))
    return frequencies[(before > 1) & (after < 1)].tolist()


def _response(
    A: Matrix, B: NDArray[np.float64], C: NDArray[np.float64], s: NDArray[np.complexfloating]
) -> NDArray[np.complexfloating]:
    """C (s - A)⁻¹ B at each s, shape (n,)."""
    shifted = s[:, None, None] * np.eye(len(A)) - A
    return np.linalg.solve(shifted, B[:, None])[:, :, 0] @ C
