"""The optimal path follower's gains and feed-forward, at one speed on one path.

State x = (e, ε, φ, δ, φ̇, δ̇, T, Ṫ): deviation of the rear contact from the path, heading error,
the simulator's roll and steer and their rates, and the torque of the rider's muscles with its rate
(without the last two, and T the input, if the muscles have no lag). With eq. 7 for roll and steer
and eq. 8, linear but exact on a path of constant curvature κ,

    ė = v ε,   ε̇ = (v δ + c δ̇) cos λ / w - v κ,   T̈ = ω² (u - T) - 2 ζ ω Ṫ

A steady turn has x = X κ and the torque u = U κ, with e = ε = 0. What is made least is

    ∫ q_e ẽ² + q_ε ε̃² + r ũ² dt,   x̃ = x - X κ,  ũ = u - U κ

so that a turn costs nothing by itself and is ridden without an error. Its solution, with P of the
Riccati equation, K = Bᵀ P / r and A_c = A - B K, is [Anderson & Moore 1990, 4.3]

    u = -K x̃ + U κ + (1/r) Bᵀ ∫ e^{A_cᵀ τ} P X κ̇(t + τ) dτ

over the preview from 0 to T_p; beyond what he sees the curvature goes on as at its end.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.real import Real
from bikesim.model.simulator import simulator_matrices
from bikesim.model.whipple import Matrix
from bikesim.path.path import Path
from bikesim.rider.base import Setting

SPACING = 0.05  # m, of the stations at which the feed-forward is known
_FORGOTTEN = 20.0  # of e^-n: the part of the preview that does not count any more
_LONGEST = 60.0  # s of preview
_SLOWEST = 1e-3  # 1/s, the least decay of a loop that counts as stable

Vector = NDArray[np.float64]


class Figures(NamedTuple):
    """What an optimal rider wants and knows of himself.

    Weights of deviation `lateral_weight` q_e [1/m²], `heading_weight` q_ε [1/rad²],
    `effort_weight` r [1/(N m)²]; `preview_time` T_p [s]; his muscles' `muscle_frequency` ω [rad/s]
    (0: no lag) and `muscle_damping_ratio` ζ; his arms: `arm_inertia` [kg m²], `arm_damping`
    [N m s/rad], `arm_stiffness` [N m/rad].
    """

    lateral_weight: float
    heading_weight: float
    effort_weight: float
    preview_time: float
    muscle_frequency: float
    muscle_damping_ratio: float
    arm_inertia: float
    arm_damping: float
    arm_stiffness: float


class Design(NamedTuple):
    """K, shape (8,) [N m per unit of the state]; what is added to -K x at the stations of the path.

    `forward` [N m], shape (m,), is for stations SPACING [m] apart, from `first` [m]; `gains` of T
    and Ṫ are zero for muscles without lag.
    """

    gains: Vector
    first: float
    forward: Vector


class FeedForward:
    """The feed-forward torque by station, of one design or of that of each rider of a batch.

    `which` design: a number, or an array (n,) of numbers.
    """

    def __init__(self, path: Path, designs: Sequence[Design], which: Any) -> None:
        longest = max(len(one.forward) for one in designs)
        self._table = np.array(
            [np.pad(one.forward, (0, longest - len(one.forward)), "edge") for one in designs]
        )
        # Of a single rider; Python's own floats are several times as fast.
        self._list: list[float] = self._table[0].tolist()
        self._which, self._path = which, path
        self._first = np.array([one.first for one in designs])[which]
        self._last = np.array([len(one.forward) - 2.0 for one in designs])[which]
        if not np.ndim(which):
            self._first, self._last = float(self._first), float(self._last)

    def __call__(self, station: Real) -> Real:
        """The torque [N m] at a station [m], linear between those of the design."""
        path = self._path
        if path.straight:
            return 0.0
        if isinstance(station, np.ndarray) or isinstance(self._first, np.ndarray):
            return self._many(station)
        if path.loop is not None and station >= path.length:
            station = (station - path.loop) % (path.length - path.loop) + path.loop
        place = (station - self._first) / SPACING
        place = min(place, self._last + 1.0) if place > 0.0 else 0.0
        row = int(min(place, self._last))
        return self._list[row] + (place - row) * (self._list[row + 1] - self._list[row])

    def _many(self, station: Real) -> Vector:
        path = self._path
        if path.loop is not None:
            again = (station - path.loop) % (path.length - path.loop) + path.loop
            station = np.where(station >= path.length, again, station)
        place = (station - self._first) / SPACING
        # A station that is no number is the first.
        place = np.fmax(np.fmin(place, self._last + 1.0), 0.0)
        row = np.minimum(place, self._last).astype(int)
        before, after = self._table[self._which, row], self._table[self._which, row + 1]
        return before + (place - row) * (after - before)


class Plant(NamedTuple):
    """ẋ = A x + B u + D κ, of the module's text: shapes (n, n), (n,), (n,)."""

    A: Matrix
    B: Vector
    D: Vector


def plant(setting: Setting, speed: float, figures: Figures) -> Plant:
    """What the rider faces at a speed [m/s], under the law that he rides with."""
    bicycle = setting.bicycle
    M, C, K = simulator_matrices(bicycle, setting.law, speed, setting.inertia)
    on_bar = np.diag([0.0, 1.0])
    M = M + figures.arm_inertia * on_bar
    C = C + figures.arm_damping * on_bar
    K = K + figures.arm_stiffness * on_bar
    turn = math.cos(bicycle.steer_axis_tilt) / bicycle.wheelbase
    A, B, D = np.zeros((8, 8)), np.zeros(8), np.zeros(8)
    A[0, 1] = speed
    A[1, 3], A[1, 5] = speed * turn, bicycle.trail * turn
    A[2:4, 4:6] = np.eye(2)
    A[4:6, 2:4], A[4:6, 4:6] = -np.linalg.solve(M, K), -np.linalg.solve(M, C)
    torque = np.linalg.solve(M, [0.0, 1.0])
    D[1] = -speed
    frequency, ratio = figures.muscle_frequency, figures.muscle_damping_ratio
    if not frequency:
        B[4:6] = torque
        return Plant(A[:6, :6], B[:6], D[:6])
    A[4:6, 6] = torque
    A[6, 7] = 1.0
    A[7, 6:] = -(frequency**2), -2 * ratio * frequency
    B[7] = frequency**2
    return Plant(A, B, D)


def steady_turn(plant: Plant) -> tuple[Vector, float]:
    """X (n,) and U of a turn of curvature 1/m: the state, and the torque [N m] that holds it."""
    # The deviation drives nothing, and is zero; the torque takes its column.
    columns = np.column_stack([plant.B, plant.A[:, 1:]])
    U, *X = np.linalg.solve(columns, -plant.D)
    return np.array([0.0, *X]), float(U)


def design(setting: Setting, speed: float, figures: Figures) -> Design:
    """Gains and feed-forward at a speed [m/s]. Raises InputError where no gains are to be had."""
    from scipy.linalg import LinAlgError, solve_continuous_are

    A, B, D = plant(setting, speed, figures)
    Q = np.zeros_like(A)
    Q[0, 0], Q[1, 1] = figures.lateral_weight, figures.heading_weight
    r = figures.effort_weight
    try:
        P = solve_continuous_are(A, B[:, None], Q, np.array([[r]]))
    except (LinAlgError, ValueError):
        raise _no_gains(speed, figures) from None
    K = B @ P / r
    A_c = A - np.outer(B, K)
    slowest = -float(np.linalg.eigvals(A_c).real.max())
    if not slowest > _SLOWEST:
        raise _no_gains(speed, figures)
    X, U = steady_turn(Plant(A, B, D))
    gains = np.zeros(8)
    gains[: len(K)] = K
    if setting.path.straight:
        return Design(gains, 0.0, np.zeros(2))
    horizon = min(figures.preview_time, _FORGOTTEN / slowest, _LONGEST)
    kernel = _kernel(A_c, B / r, P @ X, SPACING / speed, horizon)
    first, forward = _forward(setting.path, U + float(K @ X), kernel)
    return Design(gains, first, forward)


def _no_gains(speed: float, figures: Figures) -> InputError:
    return InputError(
        f"rider lqr: no gains at {speed:g} m/s for lateral_weight = {figures.lateral_weight:g}, "
        f"heading_weight = {figures.heading_weight:g}, effort_weight = {figures.effort_weight:g}: "
        "take weights nearer to 1, or another speed"
    )


def _kernel(A_c: Matrix, out: Vector, into: Vector, step: float, horizon: float) -> Vector:
    """The weights of the changes of curvature in each `step` [s] ahead, the nearest first."""
    from scipy.linalg import expm

    half = expm(A_c.T * (0.5 * step))
    further, weight = half @ half, half @ into
    kernel = np.empty(round(horizon / step))
    for j in range(len(kernel)):
        kernel[j] = out @ weight
        weight = further @ weight
    return kernel


def _forward(path: Path, turn: float, kernel: Vector) -> tuple[float, Vector]:
    """The first station and the torques, from where the path comes into sight to its end."""
    ahead = len(kernel)
    count = math.ceil(path.length / SPACING) + 2
    stations = SPACING * np.arange(-ahead, count + ahead + 1)
    curvature = path.curvature(stations)
    forward = turn * curvature[: ahead + count]
    if ahead:
        changes = np.diff(curvature)
        forward = forward + np.convolve(changes, kernel[::-1], "valid")[: len(forward)]
    return float(stations[0]), forward
