"""Figure 2: eigenvalues of bicycle and simulator over speed, for two inertias and both laws."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import Modes, bicycle_modes, simulator_modes, stability_limits
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia
from bikesim.report.paper.claims import Claim, agrees
from bikesim.report.style import BLACK, BLUE, GREEN, SKY, VERMILION, figure, label, styled

_SPEEDS = np.linspace(0, 10, 1001)
_OTHER_INERTIA = 0.3  # kg m², the paper's second case
_PAPER_SPEED = 3.5  # m/s

# Closer than this [1/s] two curves are hardly told apart on an axis of 20 1/s.
_SIMILAR = 0.3


class Distances(NamedTuple):
    """Largest distances of eigenvalues from the bicycle's over 1 to 10 m/s [1/s]."""

    weave: float
    weave_real: float
    capsize: float
    castering: float


def distances(bicycle: Bicycle, law: Law, inertia: float | None = None) -> Distances:
    """How far the simulator's modes are from the bicycle's; the weave also by its real part."""
    found = []
    for speed in _SPEEDS[_SPEEDS >= 1]:
        is_, should = simulator_modes(bicycle, law, speed, inertia), bicycle_modes(bicycle, speed)
        weave = is_.weave[0] - should.weave[0]
        found.append(
            (
                abs(weave),
                abs(weave.real),
                abs(is_.capsize - should.capsize),
                abs(is_.castering - should.castering),
            )
        )
    return Distances(*(float(value) for value in np.max(found, axis=0)))


def figure2_claims(bicycle: Bicycle) -> list[Claim]:
    """The claims of Figure 2, for the benchmark bicycle."""
    near, far = distances(bicycle, Law.PAPER), distances(bicycle, Law.PAPER, _OTHER_INERTIA)
    return [
        _modes_at_paper_speed(bicycle),
        *_limits(bicycle),
        Claim(
            "Figure 2: striking similarity to the bicycle, weave [1/s]",
            "striking",
            f"within {near.weave:.3f}",
            near.weave <= _SIMILAR,
            f"I = λ2, 1 to 10 m/s; real part within {near.weave_real:.3f}. I = 0.3: {far.weave:.2f}.",
        ),
        Claim(
            "Figure 2: striking similarity to the bicycle, capsize [1/s]",
            "striking",
            f"within {near.capsize:.3f}",
            near.capsize <= _SIMILAR,
            f"I = λ2, 1 to 10 m/s. I = 0.3: {far.capsize:.3f}.",
        ),
        Claim(
            "Figure 2: striking similarity to the bicycle, castering [1/s]",
            "striking",
            f"off by {near.castering:.2f}",
            near.castering <= _SIMILAR,
            f"I = λ2, at 10 m/s: four times as far as the weave. I = 0.3: {far.castering:.2f}.",
        ),
        _momentum(bicycle),
    ]


def _modes_at_paper_speed(bicycle: Bicycle) -> Claim:
    is_ = simulator_modes(bicycle, Law.PAPER, _PAPER_SPEED)
    should = bicycle_modes(bicycle, _PAPER_SPEED)
    printed = ("1.1367", "2.6705", "-2.1632", "-10.9161")
    weave = is_.weave[0]
    ours = (weave.real, weave.imag, is_.capsize.real, is_.castering.real)
    return Claim(
        f"Figure 2: eigenvalues of eq. 7 at {_PAPER_SPEED} m/s, I = λ2 [1/s]",
        "{} ± {}i, {}, {}".format(*printed),
        _told(is_),
        all(agrees(value, digits) for value, digits in zip(ours, printed, strict=True)),
        f"The bicycle: {_told(should)}.",
    )


def _limits(bicycle: Bicycle) -> list[Claim]:
    cases = (
        ("bicycle", stability_limits(bicycle), "4.2924"),
        ("simulator, I = λ2", stability_limits(bicycle, Law.PAPER), "4.3010"),
        (
            f"simulator, I = {_OTHER_INERTIA}",
            stability_limits(bicycle, Law.PAPER, _OTHER_INERTIA),
            "4.5108",
        ),
    )
    weave = [
        Claim(
            f"Figure 2: weave speed of the {whose} [m/s]",
            printed,
            float(limits.weave or np.nan),
            limits.weave is not None and agrees(limits.weave, printed),
        )
        for whose, limits, printed in cases
    ]
    speeds = [float(limits.capsize or np.nan) for _, limits, _ in cases]
    capsize = Claim(
        "Figure 2: capsize speed of all three [m/s]",
        "6.0243",
        speeds[0],
        all(agrees(speed, "6.0243") for speed in speeds),
        f"The three differ by {max(speeds) - min(speeds):.0e}: it does not depend on the inertia.",
    )
    return [*weave, capsize]


def _momentum(bicycle: Bicycle) -> Claim:
    apart = max(distances(bicycle, Law.MOMENTUM))
    largest = max(abs(s) for s in bicycle_modes(bicycle, _SPEEDS[-1]).all())
    return Claim(
        "Momentum law: the simulator's eigenvalues are the bicycle's [1/s]",
        None,
        f"within {apart:.0e}",
        apart <= 1e-12 * largest,
        f"With I = {handlebar_inertia(bicycle, Law.MOMENTUM):.6f} kg m² and the same two sensors: "
        "its mass matrix is M itself, term by term.",
    )


def _told(modes: Modes) -> str:
    weave = modes.weave[0]
    return f"{weave.real:.4f} ± {weave.imag:.4f}i, {modes.capsize.real:.4f}, {modes.castering.real:.4f}"


def figure2(bicycle: Bicycle) -> Figure:
    """Real parts above, imaginary below; a column for each inertia, one for the momentum law."""
    momentum = handlebar_inertia(bicycle, Law.MOMENTUM)
    cases = (
        (
            Law.PAPER,
            None,
            VERMILION,
            f"(a) law paper, I = λ2 = {handlebar_inertia(bicycle, Law.PAPER):.4f}",
        ),
        (Law.PAPER, _OTHER_INERTIA, VERMILION, f"(b) law paper, I = {_OTHER_INERTIA}"),
        (Law.MOMENTUM, None, BLUE, f"(c) law momentum, I = {momentum:.4f}"),
    )
    with styled():
        drawn = figure(7.2, 4.4)
        axes = drawn.subplots(2, 3, sharex=True, sharey="row", height_ratios=(1.5, 1))
        for column, (law, inertia, colour, title) in zip(axes.T, cases, strict=True):
            _draw(column, bicycle, law, inertia, colour)
            label(column[0], title=title)
            label(column[1], x="forward speed v [m/s]")
        axes[0, 0].set_ylabel("Re λ [1/s]")
        axes[1, 0].set_ylabel("Im λ [rad/s]")
        _name_modes(axes[0, 0])
    return drawn


def _draw(
    column: NDArray[np.object_], bicycle: Bicycle, law: Law, inertia: float | None, colour: str
) -> None:
    real, imaginary = column
    limits = stability_limits(bicycle, law, inertia)
    if limits.weave is not None and limits.capsize is not None:
        real.axvspan(limits.weave, limits.capsize, color=GREEN, alpha=0.12, lw=0)
    real.axhline(0, color=BLACK, lw=0.6)
    bare = [bicycle_modes(bicycle, speed) for speed in _SPEEDS]
    simulated = [simulator_modes(bicycle, law, speed, inertia) for speed in _SPEEDS]
    _draw_modes(real, bare, np.real, SKY, "-", 3.0, "bicycle")
    _draw_modes(real, simulated, np.real, colour, "--", 1.2, "simulator")
    _draw_modes(imaginary, bare, _frequency, SKY, "-", 3.0, "bicycle")
    _draw_modes(imaginary, simulated, _frequency, colour, "--", 1.2, "simulator")
    real.set_ylim(-26, 8)
    imaginary.set_ylim(0, 12)
    real.set_xlim(0, 10)
    real.legend(loc="lower left", handlelength=2.4)


def _draw_modes(
    axes: Axes,
    modes: list[Modes],
    part: Callable[[NDArray[np.complex128]], NDArray[np.float64]],
    colour: str,
    style: str,
    width: float,
    name: str,
) -> None:
    lines = part(np.array([found.all() for found in modes]))
    axes.plot(_SPEEDS, lines[:, 0], style, color=colour, lw=width, label=name)
    axes.plot(_SPEEDS, lines[:, 1:], style, color=colour, lw=width)


def _frequency(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.where(values.imag > 0, values.imag, np.nan)


def _name_modes(axes: Axes) -> None:
    for text, x, y in (("weave", 1.0, 5.0), ("capsize", 7.6, 1.0), ("castering", 6.2, -15.0)):
        axes.text(x, y, text, fontsize=8, style="italic")
