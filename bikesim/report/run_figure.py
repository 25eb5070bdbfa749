"""The figure of a run: angles, torques, path."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bikesim.record.reader import Run
from bikesim.report.run_path import draw_deviation, draw_ways, prescribed, thinned
from bikesim.report.style import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, figure, label, styled

_COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, GREY)
_FEEDBACK, _RIDER = "feedback torque $T_f$", "rider torque $T_δ$"
_MEASURED = "as the drive measures it"
# Above the axes, where no line runs.
_ABOVE: Any = {"loc": "lower right", "bbox_to_anchor": (1, 0.98), "ncols": 4, "borderaxespad": 0}


def run_figure(runs: Sequence[Run]) -> Figure:
    """Roll, steer, torques over time and the path over ground, one colour a run.

    Where a path other than the straight line was prescribed, also the deviation from it. Raises
    InputError for a record whose scenario's path cannot be read.
    """
    to_follow = not all(prescribed(run).straight for run in runs)
    colours = _cycle(len(runs))
    with styled():
        drawn = figure(7.2, 9.2 if to_follow else 7.6)
        heights = (1, 1, 1.2, 0.8, 1.2) if to_follow else (1, 1, 1.2, 0.9)
        axes = drawn.subplots(len(heights), 1, height_ratios=heights)
        roll, steer, torque, *deviation, path = axes
        for other in (steer, torque, *deviation):
            other.sharex(roll)
        for run, colour in zip(runs, colours, strict=True):
            _draw(run, colour, len(runs) > 1, roll, steer, torque)
            for one in deviation:
                draw_deviation(one, run, colour)
        draw_ways(path, runs, colours)
        label(roll, y="roll φ [deg]", title=_title(runs))
        label(steer, y="steer δ [deg]")
        label(torque, y="torque [N m]")
        for one in deviation:
            label(one, y="off the path [m]")
        label(axes[-2], x="time [s]", y=axes[-2].get_ylabel())
        label(path, x="forward x [m]", y="to the right y [m]")
        if len(runs) > 1:
            roll.legend(**_ABOVE)
            torque.legend(handles=_line_styles(), **_ABOVE)
        else:
            torque.legend(**_ABOVE)
    return drawn


def _draw(run: Run, colour: str, several: bool, roll: Axes, steer: Axes, torque: Axes) -> None:
    thin = thinned(run)
    time = run.time[thin]
    name = f"{_haptics(run)}, {run.rider}" if several else ""
    roll.plot(time, np.degrees(run.channel("roll")[thin]), color=colour, label=name)
    steer.plot(time, np.degrees(run.channel("steer")[thin]), color=colour)
    torque.plot(time, run.channel("sent_torque")[thin], color=colour, label=_FEEDBACK)
    if "rider_torque" in run.names:
        shade = colour if several else ORANGE
        style = "--" if several else "-"
        torque.plot(
            time, run.channel("rider_torque")[thin], style, color=shade, lw=0.9, label=_RIDER
        )
    elif "motor_torque" in run.names and not several:  # a bench, which does not know the rider's
        measured = run.channel("motor_torque")[thin]
        torque.plot(time, measured, color=GREY, lw=0.7, zorder=1, label=_MEASURED)
    if run.ending is not None and run.ending.fell:
        roll.plot(time[-1:], np.degrees(run.channel("roll")[-1:]), "x", color=colour, ms=8, mew=2)


def _line_styles() -> list[Line2D]:
    """Of several runs the colour is the run, the style the torque."""
    return [
        Line2D([], [], color=GREY, label=_FEEDBACK),
        Line2D([], [], color=GREY, linestyle="--", lw=0.9, label=_RIDER),
    ]


def _title(runs: Sequence[Run]) -> str:
    first = runs[0]
    text = first.bicycle.name
    if first.ticks:
        lowest, highest = (f(first.channel("speed")) for f in (np.min, np.max))
        text += (
            f", {lowest:.3g} m/s" if lowest == highest else f", {lowest:.3g} to {highest:.3g} m/s"
        )
    if len(runs) > 1:
        return text
    text += f", {_haptics(first)}, rider {first.rider}, rig {first.rig}"
    if first.ending is not None and first.ending.fall_time is not None:
        text += f": fell at {first.ending.fall_time:.2f} s"
    return text


def _haptics(run: Run) -> str:
    return "haptics off" if run.law == "off" else f"law {run.law}"


def _cycle(count: int) -> list[str]:
    return [_COLOURS[i % len(_COLOURS)] for i in range(count)]
