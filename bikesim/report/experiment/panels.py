"""The panels of an experiment's figures: their axes, colours and legend."""

import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.report.experiment.data import shown
from bikesim.report.experiment.layout import Layout
from bikesim.report.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION, figure, label

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, BLACK)
MARKERS = "osD^vP"
WIDTH = 7.2  # inch, of a page's text
_MANY = 6  # numbers on an axis that still fit side by side
_TITLE = 8  # points
_LETTERS = 12.0  # of such a title that an inch holds
_MARGIN = 0.08  # of the range of the numbers on an axis, on either side
_LONG = 60  # conditions of one axis above which names no longer fit


def panels(layout: Layout, y: str) -> tuple[Figure, list[Axes]]:
    """A panel for each, three in a row, with the axis of the conditions."""
    count = len(layout.panels)
    columns = 2 if count == 4 else min(3, count)
    rows = -(-count // columns)
    tilted = not layout.numeric and max(len(shown(place)) for place in layout.places) > 8
    height = 0.7 + 2.1 * rows + (1.2 if tilted else 0.0)
    drawn = figure(WIDTH if columns > 1 or len(layout.places) > 4 else 4.6, height)
    axes = list(drawn.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel())
    along = "" if layout.axis is None else layout.axis.axis
    for at, (one, title) in enumerate(zip(axes, layout.panels, strict=False)):
        _axis(one, layout, tilted)
        first, lowest = at % columns == 0, at >= count - columns
        label(one, x=along if lowest else "", y=y if first else "", title=folded(title, columns))
        one.title.set_fontsize(_TITLE)
    leave_out(axes, count, columns)
    legend(drawn, layout)
    return drawn, axes[:count]


def folded(title: str, columns: int) -> str:
    """A panel's title in lines that do not reach the next of so many panels in a row."""
    letters = int(WIDTH * _LETTERS / columns)
    return "\n".join(textwrap.fill(line, letters) for line in title.split("\n"))


def leave_out(axes: Sequence[Axes], count: int, columns: int) -> None:
    """Only the first panels of a grid; those that are now the lowest have the axis' numbers."""
    for one in axes[count:]:
        one.set_visible(False)
    for one in axes[max(0, count - columns) : count]:
        one.tick_params(labelbottom=True)


def _axis(axes: Axes, layout: Layout, tilted: bool) -> None:
    if layout.numeric:
        if is_ratio(layout.places):
            axes.set_xscale("log")
            axes.minorticks_off()
        turn: Any = {"rotation": 45, "fontsize": 7} if len(layout.places) > _MANY else {}
        axes.set_xticks(layout.places, [shown(place) for place in layout.places], **turn)
        axes.set_xlim(*_around(layout.places))
    else:
        names = [shown(place) for place in layout.places]
        if len(names) > _LONG:
            names = ["" for _ in names]
        turn = {"rotation": 40, "ha": "right", "fontsize": 7} if tilted else {}
        axes.set_xticks(range(len(names)), names, **turn)
        axes.set_xlim(-0.5, len(names) - 0.5)


def _around(places: Sequence[Any]) -> tuple[float, float]:
    """All of an axis, those places too where nothing is drawn."""
    low, high = float(min(places)), float(max(places))
    if is_ratio(places):
        by = (high / low) ** _MARGIN
        return low / by, high * by
    by = _MARGIN * (high - low)
    return low - by, high + by


def is_ratio(places: Sequence[Any]) -> bool:
    """Whether numbers are spread so far that the small ones would lie on one another."""
    return min(places) > 0 and max(places) / min(places) >= 8


def legend(drawn: Figure, layout: Layout) -> None:
    """What the colours stand for, above the panels."""
    if not layout.colours:
        return
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=COLOURS[i % len(COLOURS)], marker=MARKERS[i % len(MARKERS)], ms=4.5)
        for i in range(len(layout.colours))
    ]
    drawn.legend(handles, layout.colours, loc="outside upper right", ncols=len(layout.colours))
