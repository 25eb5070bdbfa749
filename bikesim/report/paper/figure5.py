"""Figure 5: a rider at 3.5 m/s with haptics on (a), and the same rider with haptics off (b)."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.experiment.scenario import Scenario
from bikesim.experiment.summary import summarise
from bikesim.record.reader import Run
from bikesim.report.paper.claims import Claim
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.riding import fell, recorded
from bikesim.report.style import BLACK, BLUE, ORANGE, VERMILION, figure, label, styled
from bikesim.rig.settings import RigSettings

_REAL_RIG = "delft2013"
_MOST_POINTS = 3000


class Figure5(NamedTuple):
    """The three rides: the same rider and seed; `real` with the errors of the 2013 rig."""

    on: Run
    off: Run
    real: Run


def ride_figure5(records: Path, duration: float, progress: Progress) -> Figure5:
    """Ride the default scenario, with haptics on and off, and on the 2013 rig; `duration` [s]."""
    cases = (
        ("figure5-on", Scenario(duration=duration)),
        ("figure5-off", Scenario(duration=duration, law="off")),
        ("figure5-delft2013", Scenario(duration=duration, rig=RigSettings(name=_REAL_RIG))),
    )
    rides = []
    for name, scenario in cases:
        rides.append(recorded(scenario, records / f"{name}.h5"))
        progress.step("figure 5")
    return Figure5(*rides)


def figure5_claims(rides: Figure5) -> list[Claim]:
    """The paper's headline, ridden by a model of a rider."""
    return [
        _stays_up(rides.on, "Figure 5a: with haptics on the rider stabilises 3.5 m/s"),
        _falls(rides.off),
        _stays_up(rides.real, "Figure 5a, on the 2013 rig: the rider stabilises 3.5 m/s"),
    ]


def _stays_up(ride: Run, claim: str) -> Claim:
    summary = summarise(ride)
    return Claim(
        claim,
        "as described",
        _fate(ride),
        not summary.fell,
        f"The paper had a person on its rig; here rider {ride.rider}, seed {ride.seed}, in the "
        f"virtual rig {ride.rig}. RMS roll {np.degrees(summary.rms_roll):.2f} deg, steer "
        f"{np.degrees(summary.rms_steer):.2f} deg, feedback torque "
        f"{summary.rms_feedback_torque:.3f} N m.",
    )


def _falls(ride: Run) -> Claim:
    return Claim(
        "Figure 5b: with haptics off the same rider cannot",
        "as described",
        _fate(ride),
        fell(ride),
        "The same rider, gains and seed as in 5a. Whether another could is the map's question.",
    )


def _fate(ride: Run) -> str:
    ending = ride.ending
    if ending is not None and ending.fell:
        return f"fell after {ending.fall_time:.2f} s"
    return f"stayed up for {ride.ticks * ride.period:.0f} s"


def figure5(rides: Figure5) -> Figure:
    """Angles above, torques below; a column a ride."""
    cases = (
        (rides.on, "(a) haptics on"),
        (rides.off, "(b) haptics off"),
        (rides.real, "(c) haptics on, 2013 rig"),
    )
    with styled():
        drawn = figure(7.2, 3.9)
        axes = drawn.subplots(2, 3, sharex="col", width_ratios=(1, 0.8, 1))
        for (angles, torques), (ride, title) in zip(axes.T, cases, strict=True):
            _draw(angles, torques, ride)
            label(angles, title=title)
            label(torques, x="time [s]")
        axes[0, 2].sharey(axes[0, 0])
        axes[1, 2].sharey(axes[1, 0])
        axes[0, 0].set_ylabel("angle [deg]")
        axes[1, 0].set_ylabel("torque on the bar [N m]")
        for row in axes:
            handles, names = row[0].get_legend_handles_labels()
            row[1].legend(handles, names, loc="upper left", fontsize=7, handlelength=1.4)
    return drawn


def _draw(angles: Axes, torques: Axes, ride: Run) -> None:
    thin = slice(None, None, max(1, ride.ticks // _MOST_POINTS))
    time = ride.time[thin]
    for axes in (angles, torques):
        axes.axhline(0, color=BLACK, lw=0.5)
        axes.set_xlim(0, ride.ticks * ride.period)
    angles.plot(time, np.degrees(ride.channel("roll")[thin]), color=BLUE, lw=1, label="roll φ")
    angles.plot(
        time, np.degrees(ride.channel("steer")[thin]), color=VERMILION, lw=0.7, label="steer δ"
    )
    torques.plot(
        time,
        ride.channel("rider_torque")[thin],
        color=ORANGE,
        lw=0.7,
        label="rider $T_δ$ without arms",
    )
    torques.plot(
        time, ride.channel("sent_torque")[thin], color=BLACK, lw=0.8, label="feedback $T_f$"
    )
    if fell(ride):
        angles.plot(
            time[-1:], np.degrees(ride.channel("roll")[-1:]), "x", color=BLUE, ms=7, mew=2,
            clip_on=False,
        )  # fmt: skip
