"""The figure of who is still up, over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.report.experiment.data import shown
from bikesim.report.experiment.findings import ConditionFindings, Findings
from bikesim.report.experiment.layout import Layout, Mark
from bikesim.report.experiment.panels import COLOURS, WIDTH, folded, leave_out, legend
from bikesim.report.style import figure, label, styled

_MOST_CELLS = 16  # panels of their own
_ALL = -1  # places, together in a panel


def survival_figure(findings: Findings, layout: Layout) -> Figure:
    """The share still up over time, a colour each.

    A panel for each place along the axis; where those are too many, all of its places in one panel,
    the paler the earlier.
    """
    together = without_bands(layout)
    cells = [(mark.panel, _ALL if together else mark.place) for mark in layout.marks]
    panels = sorted(set(cells))
    last = max(one.survival.last for one in findings.conditions)
    with styled():
        columns = min(3 if together else 4, len(panels))
        rows = -(-len(panels) // columns)
        drawn = figure(WIDTH, 0.6 + 1.75 * rows)
        axes = list(drawn.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel())
        for mark, cell, one in zip(layout.marks, cells, findings.conditions, strict=True):
            depth = (mark.place + 1) / len(layout.places) if together else 1.0
            _survive(axes[panels.index(cell)], mark, one, last, depth, band=not together)
        for cell, one in zip(panels, axes, strict=False):
            label(one, title=folded(_cell_title(layout, *cell), columns))
            one.title.set_fontsize(8)
        leave_out(axes, len(panels), columns)
        axes[0].set(ylim=(-4, 104), xlim=(0, last))
        along = f"time [s]; {_from_pale(layout)}" if together else "time [s]"
        drawn.supxlabel(along, fontsize=9)
        drawn.supylabel("still up [%]", fontsize=9)
        legend(drawn, layout)
    return drawn


def without_bands(layout: Layout) -> bool:
    """Whether all places are in one panel, too many for each to have its band."""
    return len({(mark.panel, mark.place) for mark in layout.marks}) > _MOST_CELLS


def _from_pale(layout: Layout) -> str:
    first, last = layout.places[0], layout.places[-1]
    what = "" if layout.axis is None else f"{layout.axis.label} "
    unit = "" if layout.axis is None else layout.axis.unit
    return f"from pale to dark: {what}{shown(first)} to {shown(last)} {unit}".rstrip()


def _survive(
    axes: Axes, mark: Mark, one: ConditionFindings, last: float, depth: float, *, band: bool
) -> None:
    found, shade = one.survival, COLOURS[mark.colour % len(COLOURS)]
    time = np.concatenate([[0.0], found.time, [last]])
    share, low, high = (
        100 * np.concatenate([[1.0], values, values[-1:] if len(values) else [1.0]])
        for values in (found.share, found.low, found.high)
    )
    if band:
        axes.fill_between(time, low, high, step="post", color=shade, alpha=0.2, lw=0)
    axes.step(time, share, where="post", color=shade, lw=1.2, alpha=0.2 + 0.8 * depth)


def _cell_title(layout: Layout, panel: int, place: int) -> str:
    if place == _ALL:
        return layout.panels[panel]
    there = layout.places[place] if layout.axis is None else layout.axis.at(layout.places[place])
    return f"{layout.panels[panel]}\n{there}" if layout.panels[panel] else there
