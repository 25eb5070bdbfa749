"""The figures of an experiment: falls, metrics, contrasts, regression."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from bikesim.experiment.metric_table import BY_NAME, FALL_TIME
from bikesim.report.experiment import words
from bikesim.report.experiment.findings import ConditionFindings, Contrast, Findings
from bikesim.report.experiment.layout import Layout
from bikesim.report.experiment.logistic import CONSTANT, Term
from bikesim.report.experiment.panels import COLOURS, MARKERS, WIDTH, is_ratio, panels
from bikesim.report.style import BLACK, BLUE, GREY, figure, label, styled

MOST_ROWS = 100
"""Differences that a figure shows: of thousands it would be too tall to be painted."""

_WIDE = 10.0  # largest over smallest median of a metric above which its axis is logarithmic


class Interval(NamedTuple):
    """What is drawn of a condition: a middle and how far it may be off."""

    middle: float
    low: float
    high: float


def falls_figure(findings: Findings, layout: Layout) -> Figure:
    """The share that fell, with Wilson intervals."""

    def share(one: ConditionFindings) -> Interval:
        return Interval(*(100 * v for v in (one.falls.share, one.falls.low, one.falls.high)))

    with styled():
        drawn, axes = panels(layout, "fell [%]")
        _draw(findings, layout, axes, share)
        for one in axes:
            one.set_ylim(-4, 104)
    return drawn


def metric_figure(findings: Findings, layout: Layout, name: str) -> Figure:
    """The median of a metric, with its interval."""
    metric = BY_NAME[name]
    at = [one.metric for one in findings.conditions[0].metrics].index(name)

    def middle(one: ConditionFindings) -> Interval:
        found = one.metrics[at]
        if found.high == math.inf:  # of the time of the fall: nobody knows when it ends
            found = found._replace(high=one.survival.last)
        return Interval(*(metric.factor * v for v in (found.median, found.low, found.high)))

    with styled():
        drawn, axes = panels(layout, words.headed(metric))
        _draw(findings, layout, axes, middle)
        _scale(axes, [middle(one).middle for one in findings.conditions])
        _say_none(axes, "not reached" if name == FALL_TIME else "none")
    return drawn


def contrasts_figure(contrasts: Sequence[Contrast], metric: str | None = None) -> Figure:
    """The differences between pairs of conditions: of falls, or the effect on a metric.

    Of more than MOST_ROWS the first, and it says so.
    """
    made = len(contrasts)
    contrasts = contrasts[:MOST_ROWS]
    with styled():
        drawn = figure(WIDTH, 0.9 + 0.22 * len(contrasts))
        axes = drawn.subplots()
        intervals, sure = _differences(contrasts, metric)
        for row, (interval, certain) in enumerate(zip(intervals, sure, strict=True)):
            _bar(axes, row, interval, BLUE if certain else GREY)
        axes.axvline(0, color=BLACK, lw=0.8)
        axes.set_yticks(range(len(contrasts)), [one.comparison.name for one in contrasts])
        axes.tick_params(axis="y", labelsize=7, length=0)
        axes.set_ylim(len(contrasts) - 0.4, -0.6)
        what = (
            "falls [percentage points]"
            if metric is None
            else f"{words.plain(metric)}: effect $d_z$"
        )
        title = f"the first {MOST_ROWS} of {made}" if made > MOST_ROWS else ""
        label(axes, x=f"difference in {what}" if metric is None else what, title=title)
    return drawn


def odds_figure(terms: Sequence[Term]) -> Figure:
    """The odds ratios of a fall, on a logarithmic axis; the constant is left out."""
    terms = [term for term in terms if term.name != CONSTANT]
    with styled():
        drawn = figure(WIDTH, 0.9 + 0.24 * len(terms))
        axes = drawn.subplots()
        for row, term in enumerate(terms):
            interval = Interval(*(np.exp(np.clip((term.estimate, term.low, term.high), -14, 14))))
            _bar(axes, row, interval, BLUE if term.p_holm < 0.05 else GREY)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
        axes.axvline(1, color=BLACK, lw=0.8)
        axes.set_yticks(range(len(terms)), [term.name for term in terms])
        axes.tick_params(axis="y", labelsize=8, length=0)
        axes.set_ylim(len(terms) - 0.4, -0.6)
        label(axes, x="odds ratio of a fall")
    return drawn


def _differences(
    contrasts: Sequence[Contrast], metric: str | None
) -> tuple[list[Interval], list[bool]]:
    if metric is None:
        rates = [one.falls for one in contrasts]
        intervals = [Interval(*(100 * v for v in (r.difference, r.low, r.high))) for r in rates]
        return intervals, [one.falls_p_holm < 0.05 for one in contrasts]
    found = [next(m for m in one.metrics if m.metric == metric) for one in contrasts]
    effects = [one.difference for one in found]
    return (
        [Interval(e.effect, e.effect_low, e.effect_high) for e in effects],
        [one.p_holm < 0.05 for one in found],
    )


def _scale(axes: list[Axes], middles: Sequence[float]) -> None:
    """Logarithmic where the small ones would all lie on the axis beside the large ones."""
    values = [value for value in middles if np.isfinite(value)]
    if not values or min(values) <= 0 or max(values) < _WIDE * min(values):
        return
    for one in axes:
        one.set_yscale("log")
        one.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        one.yaxis.set_major_formatter("{x:g}")
        one.minorticks_off()


def _say_none(axes: list[Axes], words: str) -> None:
    """A panel that has nothing to show is not one that was forgotten."""
    for one in axes:
        drawn = (np.asarray(line.get_ydata(), float) for line in one.get_lines())
        if not any(np.isfinite(values).any() for values in drawn):
            one.text(
                0.5, 0.5, words, transform=one.transAxes, ha="center", va="center", color=GREY,
                fontsize=8,
            )  # fmt: skip


def _bar(axes: Axes, row: int, interval: Interval, colour: str) -> None:
    axes.plot([interval.low, interval.high], [row, row], color=colour, lw=1.4)
    axes.plot(interval.middle, row, "o", color=colour, ms=4)


def _draw(
    findings: Findings,
    layout: Layout,
    axes: list[Axes],
    interval: Callable[[ConditionFindings], Interval],
) -> None:
    """Each colour's conditions, side by side where they would lie on one another."""
    colours = max(1, len(layout.colours))
    for panel, one in enumerate(axes):
        for colour in range(colours):
            found = sorted(
                (mark.place, interval(condition))
                for mark, condition in zip(layout.marks, findings.conditions, strict=True)
                if (mark.panel, mark.colour) == (panel, colour)
            )
            if not found:
                continue
            x = [_aside(layout, place, colour, colours) for place, _ in found]
            _points(one, x, [drawn for _, drawn in found], colour, layout.numeric)


def _points(
    axes: Axes, x: list[float], intervals: list[Interval], colour: int, joined: bool
) -> None:
    middle, low, high = (np.array(values) for values in zip(*intervals, strict=True))
    shade = COLOURS[colour % len(COLOURS)]
    axes.vlines(x, low, high, color=shade, lw=1.3)
    axes.plot(x, middle, color=shade, ls="-" if joined else "none", lw=0.8)
    # Too few runs for an interval: hollow.
    for filled, part in ((True, np.isfinite(low)), (False, ~np.isfinite(low))):
        axes.plot(
            np.array(x)[part], middle[part], MARKERS[colour % len(MARKERS)], color=shade, ms=4.5,
            mfc=shade if filled else "white",
        )  # fmt: skip


def _aside(layout: Layout, place: int, colour: int, colours: int) -> float:
    by = (colour - 0.5 * (colours - 1)) / max(colours, 4)
    if not layout.numeric:
        return place + 0.5 * by
    values = np.array(layout.places, float)
    if is_ratio(layout.places):
        step = np.min(np.diff(np.log(np.sort(values))))
        return float(values[place] * np.exp(0.7 * by * step))
    return float(values[place] + 0.7 * by * np.min(np.diff(np.sort(values))))
