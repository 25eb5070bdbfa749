"""How far a haptic loop is from an instability that the bicycle does not have."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import Modes, bicycle_modes, eigenvalues, simulator_modes
from bikesim.model.law import Law
from bikesim.model.sampled_loop import (
    RELEASED,
    Complexes,
    Controller,
    Grip,
    SampledLoop,
    controller,
    loop_matrix,
    loop_response,
)
from bikesim.model.simulator import simulator_matrices

ALLOWED_EXCESS = 0.5
"""No mode of the sampled loop is to be more than this [1/s] less stable; SCIENCE, Sec. 5."""

GRIPS: tuple[Grip, ...] = tuple(
    Grip(*arms)
    for arms in product(
        (0.0, 0.05, 0.1, 0.2, 0.5), (0.0, 0.5, 2.0, 5.0, 10.0), (0.0, 5.0, 20.0, 100.0, 500.0)
    )
)
"""From released to tight: J [kg m²], b [N m s/rad], k [N m/rad]."""


class Margin(NamedTuple):
    """The margins of a loop at a speed [m/s].

    `excess` [1/s]: how much less stable the sampled loop is than the continuous one without delay
    and filter, at the grip where that is worst; `grip`, and the `mode` [1/s] there that does it.
    `delay_margin` [s], released: the pure delay that may still be added before a mode becomes
    unstable, negative if it is so already; `delay_frequency` [rad/s], of that mode at the limit
    (inf and NaN where there is no limit). `error` [1/s]: by how much weave or capsize, whichever is
    worse, of the released loop are off the bicycle's own; `inertia_error`, the part of it that the
    inertia makes.
    """

    speed: float
    excess: float
    grip: Grip
    mode: complex
    delay_margin: float
    delay_frequency: float
    error: float
    inertia_error: float

    @property
    def is_there(self) -> bool:
        """Whether the speed may be ridden."""
        return self.excess <= ALLOWED_EXCESS and self.delay_margin > 0.0


def margin_at(
    bicycle: Bicycle,
    law: Law,
    speed: float,
    loop: SampledLoop,
    grips: Sequence[Grip] = GRIPS,
) -> Margin:
    """The margins at a forward speed [m/s]."""
    control = controller(bicycle, law, speed, loop)
    worst = max(
        (
            (*_excess(sampled, continuous_modes(bicycle, law, speed, loop, grip)), grip)
            for grip, sampled in zip(grips, _sampled(control, loop, grips), strict=True)
        ),
        key=lambda found: found[0],
    )
    limit, frequency = critical_delay(bicycle, law, speed, loop)
    return Margin(
        speed,
        worst[0],
        worst[2],
        worst[1],
        limit - loop.delay,
        frequency,
        _distance(sampled_modes(control, loop), bicycle_modes(bicycle, speed)),
        inertia_error(bicycle, law, speed, loop.felt_inertia),
    )


def inertia_error(bicycle: Bicycle, law: Law, speed: float, inertia: float) -> float:
    """By how much a handlebar of `inertia` [kg m²] puts weave or capsize of the simulator, hands
    off in continuous time, off the bicycle's own [1/s].
    """
    found = simulator_modes(bicycle, law, speed, inertia)
    return _distance(np.array(found.all()), bicycle_modes(bicycle, speed))


def sampled_modes(control: Controller, loop: SampledLoop, grip: Grip = RELEASED) -> Complexes:
    """Equivalent continuous eigenvalues s = ln(z)/T [1/s], least stable first; none for z = 0."""
    return next(_sampled(control, loop, [grip]))


def _sampled(control: Controller, loop: SampledLoop, grips: Sequence[Grip]) -> Iterator[Complexes]:
    matrices = np.array([loop_matrix(control, loop, grip) for grip in grips])
    for z in np.linalg.eigvals(matrices).astype(complex):
        s = np.log(z[np.abs(z) > 1e-6]) / (loop.period * loop.ticks_per_sample)
        yield s[np.argsort(-s.real)]


def continuous_modes(
    bicycle: Bicycle, law: Law, speed: float, loop: SampledLoop, grip: Grip = RELEASED
) -> Complexes:
    """The four [1/s] of the same loop in continuous time, without delay, lag, filter or coupling's
    give; least stable first.
    """
    handle = loop.felt_inertia - loop.inertia
    felt = np.array([[1.0], [loop.scale]])
    # A scaled torque is the law's and, of a coupling, the virtual handle's.
    mass, damping, stiffness = (
        felt * one for one in simulator_matrices(bicycle, law, speed, handle)
    )
    arms = np.array([[0.0, 0.0], [0.0, 1.0]])
    mass = mass + (loop.inertia + grip.inertia) * arms
    damping = damping + (loop.viscous_friction + grip.damping) * arms
    s = np.asarray(eigenvalues(mass, damping, stiffness + grip.stiffness * arms), complex)
    return s[np.argsort(-np.real(s))]


def _excess(sampled: Complexes, continuous: Complexes) -> tuple[float, complex]:
    """Of the least stable mode over the continuous one; of each further one, where it is unstable.

    Without the second part a mode that becomes unstable would hide behind a faster fall.
    """
    floor = np.zeros(len(sampled))
    known = min(len(continuous), len(sampled))
    floor[:known] = np.maximum(continuous.real[:known], 0.0)
    floor[0] = continuous.real[0]
    over = sampled.real - floor
    k = int(np.argmax(over))
    return float(over[k]), complex(sampled[k].real, abs(sampled[k].imag))


_GRID = 600


def critical_delay(
    bicycle: Bicycle, law: Law, speed: float, loop: SampledLoop
) -> tuple[float, float]:
    """The pure delay D [s] with which the released loop gets its first new unstable mode, and the
    mode's frequency [rad/s]; inf and NaN where no delay does that. `loop.delay` does not matter.

    At D a mode crosses the imaginary axis: |L(jω)| = 1 and arg L - ωD = -π. With rising delay it
    crosses to the right where |L| falls with ω [Walton & Marshall 1987, "Direct method for TDS
    stability analysis"]. Negative for a loop that has such a mode without any delay. Exact up to
    what a delay between two samples does to their aliases, (ωT/2π)² of it.
    """
    if law is Law.OFF:
        return math.inf, math.nan
    bare = replace(loop, delay=0.0)
    control = controller(bicycle, law, speed, bare)
    frequencies, L = _falling_through_one(control, bare)
    if not len(frequencies):
        return math.inf, math.nan
    lead = np.mod(np.angle(L) + math.pi, 2 * math.pi)
    is_worse = _unstable(sampled_modes(control, bare)) > _unstable(
        continuous_modes(bicycle, law, speed, bare)
    )
    delays = (lead - 2 * math.pi if is_worse else lead) / frequencies
    first = int(np.argmax(delays) if is_worse else np.argmin(delays))
    return float(delays[first]), float(frequencies[first])


def _falling_through_one(
    control: Controller, loop: SampledLoop
) -> tuple[NDArray[np.float64], Complexes]:
    """The ω [rad/s] where |L| falls through 1, and L there."""
    last = math.pi / (loop.period * loop.ticks_per_sample)
    grid = np.geomspace(1e-2, last * (1 - 1e-9), _GRID)
    gain = np.abs(loop_response(control, loop, grid))
    at = np.nonzero((gain[:-1] > 1.0) & (gain[1:] <= 1.0))[0]
    low, high = grid[at], grid[at + 1]
    for _ in range(40):
        middle = np.sqrt(low * high)
        above = np.abs(loop_response(control, loop, middle)) > 1.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return high, loop_response(control, loop, high)


def _unstable(modes: Complexes) -> int:
    return int(np.sum(modes.real > 1e-6))


def _distance(found: Complexes, should: Modes) -> float:
    """Of weave and capsize from the nearest that there is [1/s], the larger of both."""
    return max(float(np.abs(found - mode).min()) for mode in (should.weave[0], should.capsize))
