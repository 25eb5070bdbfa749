"""The figure of the maps: least growth rate with haptics on and off, and who can balance what."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from bikesim.model.law import Law
from bikesim.report.paper.map_claims import SOFT_ARMS, STIFF_ARMS
from bikesim.report.paper.stability_map import VISUAL_DELAY, Check, StabilityMap
from bikesim.report.style import BLACK, GREEN, GREY, ORANGE, SKY, figure, label, styled

_RANGE = Normalize(-2, 2)
_COLOURS = "RdBu_r"
# By number: haptics on only, both, off only, neither.
_VERDICTS = (
    (GREEN, "with haptics on only"),
    (SKY, "with haptics on and off"),
    (ORANGE, "with haptics off only"),
    (GREY, "with neither"),
)
_OPACITY = 0.6
_FINE = 241  # points across an interpolated map


def map_figure(delays: StabilityMap, dampings: StabilityMap, checks: Sequence[Check]) -> Figure:
    """Above over the visual delay, below over the arms' damping; on, off, who can balance."""
    with styled():
        drawn = figure(7.2, 5.9)
        maps, key = drawn.subfigures(2, 1, squeeze=False, height_ratios=(1, 0.2))[:, 0]
        axes = maps.subplots(2, 3, sharey=True)
        kinds = {*_row(axes[0], delays, "abc"), *_row(axes[1], dampings, "def")}
        for column, law in enumerate((Law.PAPER, Law.OFF)):
            _mark_checks(axes[0, column], [check for check in checks if check.law is law])
        for above, below in axes.T:
            _mark_arms(below)
            label(above, x="visual delay τ [s]")
            label(below, x="arm damping b [N m s/rad]")
        axes[0, 0].set_ylabel("arm stiffness k [N m/rad]\n(b = 0.2 s · k)")
        axes[1, 0].set_ylabel(f"arm stiffness k [N m/rad]\n(τ = {VISUAL_DELAY} s)")
        _key(key, kinds)
    return drawn


def _row(axes: NDArray[np.object_], found: StabilityMap, letters: str) -> set[int]:
    """Draws three panels; gives the kinds of verdict that occur."""
    columns, stiffnesses, on, off = _finer(found)
    for panel, rates in zip(axes, (on, off), strict=False):
        panel.pcolormesh(columns, stiffnesses, rates, cmap=_COLOURS, norm=_RANGE, rasterized=True)
        if rates.min() < 0 < rates.max():
            panel.contour(columns, stiffnesses, rates, levels=[0], colors=BLACK, linewidths=1.2)
    kinds = np.select(
        [(on < 0) & (off >= 0), (on < 0) & (off < 0), (on >= 0) & (off < 0)], [0, 1, 2], default=3
    )
    axes[2].pcolormesh(
        columns, stiffnesses, kinds, cmap=ListedColormap([colour for colour, _ in _VERDICTS]),
        vmin=-0.5, vmax=3.5, alpha=_OPACITY, rasterized=True,
    )  # fmt: skip
    for panel, letter, name in zip(
        axes, letters, ("haptics on", "haptics off", "who can balance"), strict=True
    ):
        panel.set_title(f"({letter}) {name}")
        panel.grid(visible=False)
    return set(np.unique(kinds).tolist())


def _finer(found: StabilityMap) -> tuple[NDArray[np.float64], ...]:
    """The map interpolated linearly: columns, stiffnesses, growth rates on and off."""
    from scipy.interpolate import RegularGridInterpolator

    columns = np.linspace(found.columns[0], found.columns[-1], _FINE)
    stiffnesses = np.linspace(found.stiffnesses[0], found.stiffnesses[-1], _FINE)
    at = np.stack(np.meshgrid(stiffnesses, columns, indexing="ij"), axis=-1)
    known = found.stiffnesses, found.columns
    rates = (found.growth_rates(law) for law in (Law.PAPER, Law.OFF))
    return columns, stiffnesses, *(RegularGridInterpolator(known, rate)(at) for rate in rates)


class _Mark(NamedTuple):
    name: str
    marker: str
    size: float
    face: str

    def line(self, xs: Sequence[float] = (), ys: Sequence[float] = ()) -> Line2D:
        return Line2D(
            xs, ys, ls="", marker=self.marker, ms=self.size, mfc=self.face, mec=BLACK, mew=1,
            clip_on=False, zorder=5, label=self.name,
        )  # fmt: skip


_DIED_OUT = _Mark("ridden: dies out", "o", 4, "none")
_GREW = _Mark("ridden: grows", "x", 4, "none")
_SOFT = _Mark("soft arms", "*", 9, "white")
_STIFF = _Mark("stiff arms", "s", 6, "white")


def _mark_checks(axes: Axes, checks: Sequence[Check]) -> None:
    for grew, mark in ((False, _DIED_OUT), (True, _GREW)):
        places = [check.cell.condition for check in checks if check.roll.grew == grew]
        stiffnesses = [place.arms.stiffness for place in places]
        axes.add_line(mark.line([place.delay for place in places], stiffnesses))


def _mark_arms(axes: Axes) -> None:
    for arms, mark in ((SOFT_ARMS, _SOFT), (STIFF_ARMS, _STIFF)):
        axes.add_line(mark.line([arms.damping], [arms.stiffness]))


def _key(below: SubFigure, kinds: set[int]) -> None:
    """The scale of growth rates, what the marks mean, and the colours of who can balance."""
    bar = below.colorbar(
        ScalarMappable(_RANGE, _COLOURS), cax=below.add_axes((0.1, 0.8, 0.5, 0.14)),
        orientation="horizontal", extend="both",
    )  # fmt: skip
    bar.set_label("least growth rate of any roll PD rider [1/s]", labelpad=1)
    marks = [mark.line() for mark in (_DIED_OUT, _GREW, _SOFT, _STIFF)]
    below.legend(
        handles=marks, loc="lower center", bbox_to_anchor=(0.35, -0.04), ncols=4,
        columnspacing=1, handletextpad=0.1,
    )  # fmt: skip
    patches = [
        Patch(color=colour, label=name, alpha=_OPACITY)
        for i, (colour, name) in enumerate(_VERDICTS)
        if i in kinds
    ]
    below.legend(handles=patches, loc="upper left", bbox_to_anchor=(0.69, 1.1))
