"""The path of a run in a figure: the one prescribed, the one ridden, and between them."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from bikesim.errors import InputError
from bikesim.experiment.history import History
from bikesim.experiment.tracking import deviations
from bikesim.path.building import make_path
from bikesim.path.path import Path, path_points
from bikesim.path.settings import PathSettings
from bikesim.record.reader import Run
from bikesim.report.style import GREY
from bikesim.textfile import parse_toml

_MOST_POINTS = 6000  # more than a page can show
_LONG = 12.0  # times as long as it is wide, drawn to scale a path is a line


def prescribed(run: Run) -> Path:
    """The path of the run's scenario; the straight line if it says none. Raises InputError."""
    try:
        table = parse_toml(run.scenario).get("path", {})
        return make_path(PathSettings(**table if isinstance(table, dict) else {"kind": table}))
    except InputError as error:
        raise InputError(f"{run.path}: its scenario: {error}") from None


def draw_ways(axes: Axes, runs: Sequence[Run], colours: Sequence[str]) -> None:
    """What was to be ridden, in grey, and what was; to scale unless that shows nothing."""
    paths = {prescribed(run): _distance(run) for run in runs}
    for path, distance in paths.items():
        if not path.straight:
            end = min(distance, path.length) if path.closed else distance
            x, y = path_points(path, 0.0, max(1.0, end)).T
            axes.plot(x, y, color=GREY, lw=3, alpha=0.35, solid_capstyle="butt", zorder=1)
    for run, colour in zip(runs, colours, strict=True):
        thin = thinned(run)
        axes.plot(run.channel("x")[thin], run.channel("y")[thin], color=colour)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    if all(path.straight for path in paths) or right - left < _LONG * (high - low):
        axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()  # seen from above with x to the right, right is down


def draw_deviation(axes: Axes, run: Run, colour: str) -> None:
    """The distance from the prescribed path over time."""
    history = History.of_run(run)
    axes.plot(history.time, deviations(history, prescribed(run)), color=colour)


def thinned(run: Run) -> slice:
    """As many ticks as a page can show."""
    return slice(None, None, max(1, run.ticks // _MOST_POINTS))


def _distance(run: Run) -> float:
    return float(np.sum(run.channel("speed")) * run.period)
