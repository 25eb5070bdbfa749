"""The figure of the identified riders: growth rates, and roll over time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.record.reader import Run
from bikesim.report.paper.identified import IdentifiedRide
from bikesim.report.paper.riding import fell
from bikesim.report.style import BLACK, BLUE, GREY, VERMILION, figure, label, styled

_ACROSS = 5
_SHOWN = 6.0  # s
_HIGHEST = 4.0  # deg


def identified_figure(rides: Sequence[IdentifiedRide]) -> Figure:
    """Growth rates of all riders above, below them a small plot of roll for each."""
    with styled():
        drawn = figure(7.2, 7.0)
        rows = -(-len(rides) // _ACROSS)
        parts = drawn.subfigures(2, 1, squeeze=False, height_ratios=(1, 0.85 * rows))
        above, below = parts[:, 0]
        _growth_rates(above.subplots(), rides)
        grid = below.subplots(rows, _ACROSS, sharex=True, sharey=True, squeeze=False)
        for axes in grid.flat[len(rides) :]:
            axes.set_visible(False)
        for axes, ride in zip(grid.flat, rides, strict=False):
            _roll(axes, ride)
        below.suptitle(
            "(b) virtual rig, from 1 deg of roll; dotted: fallen, or the bar at its stop",
            fontsize=9, fontweight="bold", x=0.01, ha="left",
        )  # fmt: skip
        below.supxlabel("time [s]", fontsize=9)
        below.supylabel("roll φ [deg]", fontsize=9)
    return drawn


def _growth_rates(axes: Axes, rides: Sequence[IdentifiedRide]) -> None:
    places = range(len(rides))
    drawn = (
        ("bicycle", "_", GREY, [ride.growth.bicycle for ride in rides]),
        ("haptics on", "o", BLUE, [ride.growth.on for ride in rides]),
        ("haptics off", "X", VERMILION, [ride.growth.off for ride in rides]),
    )
    axes.axhline(0, color=BLACK, lw=0.8)
    for name, marker, colour, values in drawn:
        size = 12 if marker == "_" else 5
        axes.plot(places, values, marker, color=colour, ms=size, mew=1.5, label=name)
    axes.set_xticks(places, [f"{ride.run.run}\n{ride.run.speed:.2f}" for ride in rides])
    axes.tick_params(axis="x", labelsize=7.5)
    axes.grid(axis="x", visible=False)
    axes.legend(loc="upper left", ncols=3)
    axes.set_ylim(-2.5, 9.5)
    label(axes, x="identified run, speed [m/s]", y="growth rate [1/s]")
    axes.set_title("(a) linear analysis, least stable mode")


def _roll(axes: Axes, ride: IdentifiedRide) -> None:
    axes.axhline(0, color=BLACK, lw=0.5)
    _trace(axes, ride.on, BLUE)
    _trace(axes, ride.off, VERMILION)
    axes.set_xlim(0, _SHOWN)
    axes.set_ylim(-_HIGHEST, _HIGHEST)
    axes.set_title(f"{ride.run.run}, {ride.run.speed:.2f} m/s", fontsize=8, fontweight="normal")


def _trace(axes: Axes, record: Run, colour: str) -> None:
    roll = np.degrees(record.channel("roll"))
    axes.plot(record.time, roll, color=colour, lw=1)
    if fell(record):
        axes.axvline(record.time[-1], color=colour, lw=0.8, ls=":")
