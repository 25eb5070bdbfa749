"""How punctual a ride was, from its record: lateness and compute time of its ticks."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.record.reader import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERCENTILES = (50.0, 99.0, 99.9, 100.0)
_NAMES = ("p50", "p99", "p99.9", "max")
_BINS = (0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)  # µs
_WIDTH = 40


class Timing(NamedTuple):
    """Lateness and compute time of each tick [s], and the ticks left out as they were past."""

    late: NDArray[np.float64]
    compute: NDArray[np.float64]
    skipped: int


def timing_report(run: Run) -> Timing:
    """Of a bench's record; the first tick is on its deadline by definition."""
    skipped = run.channel("skipped")
    last = int(skipped[-1]) if len(skipped) else 0
    return Timing(run.channel("late"), run.timing("compute_time"), last)


def percentiles(seconds: NDArray[np.float64]) -> dict[str, float]:
    """p50, p99, p99.9 and max [µs]."""
    values = np.percentile(1e6 * seconds, PERCENTILES).tolist()
    return dict(zip(_NAMES, values, strict=True))


def timing_json(timing: Timing) -> dict[str, Any]:
    """For --json."""
    return {
        "ticks": len(timing.late),
        "skipped": timing.skipped,
        "late_us": percentiles(timing.late),
        "compute_us": percentiles(timing.compute),
    }


def timing_told(timing: Timing, *, histogram: bool) -> list[str]:
    """For a person."""
    lines = [f"ticks    {len(timing.late)}, {timing.skipped} left out"]
    for name, values in (("late", timing.late), ("compute", timing.compute)):
        told = ", ".join(f"{key} {value:.0f}" for key, value in percentiles(values).items())
        lines.append(f"{name:8} {told} µs")
        if histogram:
            lines += _histogram(values)
    return lines


def _histogram(seconds: NDArray[np.float64]) -> list[str]:
    edges = (*_BINS, np.inf)
    counts, _ = np.histogram(1e6 * seconds, edges)
    most = max(int(counts.max()), 1)
    return [
        f"  {_bin(low, high):>14} µs {'#' * round(_WIDTH * count / most):{_WIDTH}} {count}"
        for low, high, count in zip(edges[:-1], edges[1:], counts.tolist(), strict=True)
        if count
    ]


def _bin(low: float, high: float) -> str:
    return f"from {low:g}" if high == np.inf else f"{low:g} to {high:g}"


def timing_figure(run: Run, timing: Timing) -> "Figure":
    """Both as histograms, logarithmic both ways."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    named = (("late after the deadline", timing.late), ("computing", timing.compute))
    for axis, (name, values) in zip(axes, named, strict=True):
        micro = np.maximum(1e6 * values, 1.0)
        axis.hist(micro, bins=np.geomspace(1, max(micro.max(), 10.0) * 1.01, 60), color="0.35")
        axis.set(xscale="log", yscale="log", xlabel=f"{name} [µs]")
        for key, value in percentiles(values).items():
            axis.axvline(max(value, 1.0), color="tab:red", lw=0.7)
            axis.text(max(value, 1.0), 0.98, f" {key}", transform=axis.get_xaxis_transform(),
                      rotation=90, va="top", fontsize=7, color="tab:red")  # fmt: skip
    axes[0].set_ylabel("ticks")
    figure.suptitle(f"{run.path.name}: {len(timing.late)} ticks of {1e3 * run.period:g} ms")
    return figure
