"""The whole sampled loop as matrices: bar, delay, drive's lag, sensor, filter, law, hold."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.coupling import CoupledBicycle, Coupling, virtual_coupling
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia
from bikesim.model.whipple import Matrix

Complexes = NDArray[np.complex128]


class Grip(NamedTuple):
    """What hands add to a bar: inertia [kg m²], damping [N m s/rad], stiffness [N m/rad]."""

    inertia: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0


RELEASED = Grip()


@dataclass(frozen=True)
class SampledLoop:
    """What closes the haptic loop, as figures; SI.

    `inertia` of the bar without arms [kg m²]. `delay` [s]: all dead time from the bar's motion to
    torque, sensor and drive together (only their sum matters to a linear loop), without the hold of
    a torque over a `period`, which is there besides. `motor_lag` [s], a time constant.
    `sensor_interval` [s] between two sensor values, where it is longer than the period, is taken as
    a whole number of periods. The filter is a low pass on angle and rate alike [rad/s], or, which
    is the same to a linear loop, on the torque. `scale` of the torque, 1: the law's.
    """

    inertia: float
    period: float = 0.001
    delay: float = 0.0
    motor_lag: float = 0.0
    sensor_interval: float = 0.0
    filter_cutoff: float | None = None
    filter_order: int = 2
    viscous_friction: float = 0.0
    coupling: Coupling | None = None
    scale: float = 1.0

    @property
    def ticks_per_sample(self) -> int:
        """Ticks that see the same sensor value."""
        return max(1, round(self.sensor_interval / self.period))

    @property
    def felt_inertia(self) -> float:
        """Of bar and virtual handle together [kg m²]: what a slow motion feels."""
        return self.inertia + (self.coupling.inertia if self.coupling else 0.0)


def with_coupling(
    loop: SampledLoop, share: float, bicycle: Bicycle, law: Law, frequency: float | None = None
) -> SampledLoop:
    """The same loop with a virtual coupling for a `share` (0 to 1) of the inertia that its bar
    lacks; `frequency` [rad/s] as in `virtual_coupling`. Raises InputError.
    """
    coupling = virtual_coupling(
        share,
        inertia=loop.inertia,
        wanted=handlebar_inertia(bicycle, law),
        delay=loop.delay + loop.motor_lag,
        period=max(loop.period, loop.sensor_interval),
        frequency=frequency,
    )
    return replace(loop, coupling=coupling)


class Controller(NamedTuple):
    """From sample to torque: x' = A x + B y, u = C x + D y, with y = (δ, δ̇) of the new tick."""

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix


# What the next step needs of a state; of the redundant ones each column is taken by itself.
_KEPT = ("roll", "momentum", "roll_forcing", "momentum_forcing")
_WITH_HANDLE = (
    *_KEPT, "roll_rate", "roll_acceleration", "steer", "steer_rate", "feedback_torque",
)  # fmt: skip


def controller(bicycle: Bicycle, law: Law, speed: float, loop: SampledLoop) -> Controller:
    """Law, coupling and filter of a loop at a speed [m/s], read off the code that runs in it."""
    if loop.coupling is None:
        coded, kept = HapticBicycle(bicycle, law), _KEPT
    else:
        coded, kept = CoupledBicycle(bicycle, law, loop.coupling), _WITH_HANDLE
    rest = coded.start(speed=speed)
    columns = []
    for column in np.eye(len(kept) + 2).tolist():
        before = rest._replace(**dict(zip(kept, column[:-2], strict=True)))
        now = coded.step(before, loop.period, column[-2], column[-1], speed)
        columns.append([*(getattr(now, name) for name in kept), now.feedback_torque])
    table, n = np.array(columns).T, len(kept)
    given = loop.scale * table[n:]
    found = Controller(table[:n, :n], table[:n, n:], given[:, :n], given[:, n:])
    if loop.filter_cutoff is None:
        return found
    return _behind_filter(found, loop)


def _behind_filter(law: Controller, loop: SampledLoop) -> Controller:
    F = _filter(loop)
    two = np.eye(2)
    A_f, B_f = np.kron(two, F.A), np.kron(two, F.B)
    C_f, D_f = np.kron(two, F.C), np.kron(two, F.D)
    n, m = len(law.A), len(A_f)
    A = np.block([[law.A, law.B @ C_f], [np.zeros((m, n)), A_f]])
    B = np.asarray(np.vstack([law.B @ D_f, B_f]), float)
    return Controller(A, B, np.hstack([law.C, law.D @ C_f]), law.D @ D_f)


def _filter(loop: SampledLoop) -> Controller:
    """The Butterworth low pass of `low_pass.LowPass`, of one signal."""
    from scipy.signal import butter, zpk2ss

    assert loop.filter_cutoff is not None
    nyquist = np.pi / loop.period
    if loop.filter_cutoff >= nyquist:
        raise InputError(
            f"filter = {loop.filter_cutoff} rad/s: must be below {nyquist:.6g} rad/s, half the "
            f"sampling frequency at a period of {loop.period} s"
        )
    zeros, poles, gain = butter(loop.filter_order, loop.filter_cutoff / nyquist, output="zpk")
    A, B, C, D = (np.array(one, float) for one in zpk2ss(zeros, poles, gain))
    return Controller(A, B, C, D)


# Of a period: rounding is no part of one.
_WHOLE = 1e-9


def loop_matrix(control: Controller, loop: SampledLoop, grip: Grip = RELEASED) -> Matrix:
    """One sensor interval of the loop: bar, controller, the sample held, torques under way."""
    bar, periods = _Bar(loop, grip), loop.delay / loop.period
    whole = int(periods + _WHOLE)
    part = (periods - whole) * loop.period if periods - whole > _WHOLE else 0.0
    nb, nc, held = len(bar.generator) - 1, len(control.A), 2 if loop.ticks_per_sample > 1 else 0
    size = nb + nc + held + whole + (2 if part > 0 else 1)
    queue = nb + nc + held

    moved = np.zeros((size, size))
    if part > 0:
        first, second = bar.transition(part), bar.transition(loop.period - part)
        moved[:nb, :nb] = second[0] @ first[0]
        moved[:nb, queue] = second[0] @ first[1]
        moved[:nb, queue + 1] = second[1]
    else:
        moved[:nb, :nb], moved[:nb, queue] = bar.transition(loop.period)
    moved[queue:-1, queue + 1 :] = np.eye(size - queue - 1)
    kept = moved.copy()
    seen = moved[:2]
    if held:
        moved[nb + nc : queue] = seen
        kept[nb + nc : queue, nb + nc : queue] = np.eye(2)
    _act(moved, seen, control, nb)
    if not held:
        return moved
    _act(kept, kept[nb + nc : queue].copy(), control, nb)
    return np.linalg.matrix_power(kept, loop.ticks_per_sample - 1) @ moved


def _act(matrix: Matrix, seen: Matrix, control: Controller, nb: int) -> None:
    """The controller's rows, and that of its torque, for the sample that it sees."""
    law = slice(nb, nb + len(control.A))
    matrix[law] = control.B @ seen
    matrix[law, law] += control.A
    matrix[-1] = control.D @ seen
    matrix[-1, law] += control.C[0]


class _Bar:
    """I δ̈ + b δ̇ + k δ = τ, τ̇ = (u - τ) / lag where there is a lag."""

    def __init__(self, loop: SampledLoop, grip: Grip) -> None:
        inertia = loop.inertia + grip.inertia
        damping = loop.viscous_friction + grip.damping
        n = 2 if loop.motor_lag == 0 else 3
        self.generator = np.zeros((n + 1, n + 1))
        self.generator[0, 1] = 1.0
        self.generator[1, :3] = [-grip.stiffness / inertia, -damping / inertia, 1.0 / inertia]
        if n == 3:
            self.generator[2, 2:] = [-1.0 / loop.motor_lag, 1.0 / loop.motor_lag]

    def transition(self, time: float) -> tuple[Matrix, np.ndarray]:
        """Over a time [s] of constant torque: of the state, and of that torque."""
        from scipy.linalg import expm

        moved = expm(self.generator * time)
        return moved[:-1, :-1], moved[:-1, -1]


def loop_response(control: Controller, loop: SampledLoop, frequencies: np.ndarray) -> Complexes:
    """L(e^{jωT}) (n,) of the released loop without its `delay`, at ω (n,) [rad/s].

    1 + L e^{-jωD} = 0 at its modes. Of a sensor slower than the loop, the first harmonic.
    """
    bar = _Bar(loop, RELEASED)
    A, B = bar.transition(loop.period)
    z = np.exp(1j * frequencies * loop.period)[:, None, None]
    seen = np.linalg.solve(z * np.eye(len(A)) - A, B[:, None])[:, :2]
    inside = np.linalg.solve(z * np.eye(len(control.A)) - control.A, control.B @ seen)
    answer = (control.C @ inside + control.D @ seen)[:, 0, 0]
    n = loop.ticks_per_sample
    w = frequencies * loop.period
    held = np.exp(-0.5j * w * (n - 1)) * np.sinc(n * w / (2 * np.pi)) / np.sinc(w / (2 * np.pi))
    return np.asarray(-answer * held, complex)
