"""Eigenvalues over speed, as in Figure 2 of the paper."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.model.eigen import Modes
from bikesim.report.eigenvalue_table import EigenvalueTable, eigenvalue_table
from bikesim.report.style import BLACK, BLUE, GREEN, VERMILION, figure, label, styled

_DRAWN = (
    ("bicycle", BLACK, "-", 2.2),
    ("paper", VERMILION, "--", 1.3),
    ("momentum", BLUE, ":", 1.6),
)
_POINTS = 401


def eigenvalue_figure(table: EigenvalueTable) -> Figure:
    """Real (left) and imaginary (right) parts over speed, bicycle and both laws.

    A table of a few speeds is drawn on a fine grid from 0 to its last speed, or to 10 m/s.
    """
    speeds = [row.speed for row in table.rows]
    last = max(*speeds, 10.0) if len(speeds) > 1 else max(speeds[0], 10.0)
    fine = eigenvalue_table(table.bicycle, np.linspace(0, last, _POINTS).tolist(), table.inertia)
    with styled():
        drawn = figure(7.2, 3.6)
        real, imaginary = drawn.subplots(1, 2)
        draw_real_parts(real, fine)
        draw_part(imaginary, fine, lambda s: s.imag if s.imag > 0 else np.nan)
        _name_modes(real, fine)
        label(real, x="forward speed v [m/s]", y="Re λ [1/s]", title=table.bicycle.name)
        label(imaginary, x="forward speed v [m/s]", y="Im λ [rad/s]", title=_inertias(table))
        imaginary.set_xlim(real.get_xlim())
        imaginary.legend(loc="upper left")
    return drawn


def _name_modes(axes: Axes, table: EigenvalueTable) -> None:
    """The modes by name, each beside its own line at a speed where the lines lie apart."""
    row = min(table.rows, key=lambda row: abs(row.speed - 2.5))
    for name, s, side in (
        ("weave", row.bicycle.weave[0], "left"),
        ("capsize", row.bicycle.capsize, "right"),
        ("castering", row.bicycle.castering, "left"),
    ):
        axes.annotate(
            name, (row.speed, s.real), (0, 6), textcoords="offset points", fontsize=8, ha=side
        )


def draw_real_parts(axes: Axes, table: EigenvalueTable, lowest: float = -12.0) -> None:
    """Real parts of all modes, with the self-stable range of the bicycle shaded."""
    draw_part(axes, table, lambda s: s.real)
    axes.axhline(0, color=BLACK, lw=0.8)
    axes.set_ylim(lowest, 8)
    if table.limits.weave is not None and table.limits.capsize is not None:
        axes.axvspan(table.limits.weave, table.limits.capsize, color=GREEN, alpha=0.12, lw=0)
        middle = (table.limits.weave + table.limits.capsize) / 2
        axes.text(middle, 7.6, "self-stable", ha="center", va="top", fontsize=8, color=GREEN)


def draw_part(axes: Axes, table: EigenvalueTable, part: Callable[[complex], float]) -> None:
    """One part of all modes over speed, as lines that do not jump from mode to mode."""
    speeds = [row.speed for row in table.rows]
    for whose, colour, style, width in _DRAWN:
        modes: list[Modes] = [getattr(row, whose) for row in table.rows]
        lines = np.array([[part(s) for s in found.all()] for found in modes])
        for i, values in enumerate(lines.T):
            name = _NAMES[whose] if i == 0 else None
            axes.plot(speeds, values, style, color=colour, lw=width, label=name)


_NAMES = {
    "bicycle": "bicycle",
    "paper": "simulator, law paper",
    "momentum": "simulator, law momentum",
}


def _inertias(table: EigenvalueTable) -> str:
    if table.inertia is not None:
        return f"I = {table.inertia:.4g} kg m²"
    return f"I = {table.inertia_paper:.4f} / {table.inertia_momentum:.4f} kg m²"
