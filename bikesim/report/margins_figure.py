"""Margins over speed: the delay that the loop survives, and what sampling makes of the modes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.model.margins import ALLOWED_EXCESS, critical_delay
from bikesim.report.margins_table import MarginsTable
from bikesim.report.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, figure, label, styled

_POINTS = 61


def margins_figure(table: MarginsTable) -> Figure:
    """Left: the delay survived over speed and the loop's own; right: excess and errors."""
    with styled():
        drawn = figure(7.2, 3.8)
        delays, modes = drawn.subplots(1, 2)
        _draw_delays(delays, table)
        _draw_modes(modes, table)
        delays.set_xlim(modes.get_xlim())
    return drawn


def _draw_delays(axes: Axes, table: MarginsTable) -> None:
    speeds = [row.speed for row in table.rows]
    fine = np.linspace(min(speeds), max(speeds), _POINTS if len(speeds) > 1 else 1)
    survived = np.array(
        [critical_delay(table.bicycle, table.law, float(v), table.loop)[0] for v in fine]
    )
    ms = 1e3 * np.where(np.isfinite(survived), survived, np.nan)
    own = 1e3 * table.loop.delay
    style = "-" if len(fine) > 1 else "o"
    axes.plot(fine, ms, style, color=BLUE, label="survived, released")
    axes.axhline(own, color=BLACK, lw=1, ls="--", label=f"the loop's own, {own:g} ms")
    axes.fill_between(fine, own, ms, where=list(ms > own), color=GREEN, alpha=0.12, lw=0)
    axes.fill_between(fine, own, ms, where=list(ms <= own), color=VERMILION, alpha=0.2, lw=0)
    top = np.nanmedian(ms) if np.isfinite(ms).any() else own
    axes.set_ylim(min(0.0, float(np.nanmin(ms, initial=0.0))), max(3 * float(top), 2 * own, 1.0))
    label(axes, x="forward speed v [m/s]", y="pure delay [ms]", title=table.bicycle.name)
    _legend_below(axes)


def _draw_modes(axes: Axes, table: MarginsTable) -> None:
    speeds = [row.speed for row in table.rows]
    for name, colour, marker, values in (
        ("less stable, worst grip", VERMILION, "o", [row.excess for row in table.rows]),
        ("off the bicycle, released", BLUE, "s", [row.error for row in table.rows]),
        ("of that, by inertia", ORANGE, "^", [row.inertia_error for row in table.rows]),
    ):
        axes.plot(speeds, values, marker=marker, ms=3.5, color=colour, label=name)
    axes.axhline(ALLOWED_EXCESS, color=BLACK, lw=1, ls="--", label=f"allowed, {ALLOWED_EXCESS:g}")
    highest = max(max(row.excess, row.error) for row in table.rows)
    if highest > 20:
        axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(bottom=min(-0.05, *(row.excess for row in table.rows)))
    simulated = f" + {table.loop.coupling.inertia:.3g}" if table.loop.coupling else ""
    title = f"I = {table.loop.inertia:.3g}{simulated} of {table.wanted_inertia:.3g} kg m²"
    label(axes, x="forward speed v [m/s]", y="[1/s]", title=title)
    _legend_below(axes)


def _legend_below(axes: Axes) -> None:
    """Lines may be anywhere in the axes."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, columnspacing=1.2)
