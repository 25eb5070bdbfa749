"""What the metrics are computed from: the signals of a run at 100 Hz or less."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bikesim.record.header import Ending

if TYPE_CHECKING:
    from bikesim.record.reader import Run

HIGHEST_RATE = 100.0
"""Samples a second of a history, at most [Hz]."""

# The channels of a record that a history has; those of the virtual rig are NaN where there is none.
SIGNALS = (
    "time", "steer", "steer_rate", "true_steer", "true_steer_rate", "speed", "roll", "roll_rate",
    "heading", "x", "y", "feedback_torque", "sent_torque", "rider_torque", "roll_moment",
    "steer_moment",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class History:
    """The signals of a run: arrays (m,), SI and radians, signs as in the record.

    Every `every`-th tick, the first included, unfiltered; `period` [s] lies between two samples.
    `ticks` were ridden in all, the last of them after the last sample or at it.
    `planned_duration` [s] is what the scenario asked for. `steer` and `steer_rate` are what the
    sensors said, after noise, delay and filter; `true_steer` and `true_steer_rate` are of the bar
    itself. A bench and a replay know the sensed ones alone, which then stand for both.
    """

    period: float
    every: int
    ticks: int
    ending: Ending
    planned_duration: float
    time: NDArray[np.float64]
    steer: NDArray[np.float64]
    steer_rate: NDArray[np.float64]
    true_steer: NDArray[np.float64]
    true_steer_rate: NDArray[np.float64]
    speed: NDArray[np.float64]
    roll: NDArray[np.float64]
    roll_rate: NDArray[np.float64]
    heading: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    feedback_torque: NDArray[np.float64]
    sent_torque: NDArray[np.float64]
    rider_torque: NDArray[np.float64]
    roll_moment: NDArray[np.float64]
    steer_moment: NDArray[np.float64]

    @property
    def duration(self) -> float:
        """Time ridden [s], the period of the last tick included."""
        return self.ticks * (self.period / self.every)

    @classmethod
    def of_run(cls, run: "Run", planned_duration: float | None = None) -> "History":
        """Of a record. `planned_duration` [s]: by default what its scenario says."""
        if planned_duration is None:
            planned_duration = _planned(run)
        every = stride(run.period)
        missing = np.full(run.ticks, np.nan)
        known = set(run.names)
        values = {n: (run.channel(n) if n in known else missing)[::every] for n in SIGNALS}
        for name in ("steer", "steer_rate"):
            if f"true_{name}" not in known:
                values[f"true_{name}"] = values[name]
        return cls(
            period=every * run.period,
            every=every,
            ticks=run.ticks,
            ending=run.ending or Ending("not closed: killed, or still running"),
            planned_duration=planned_duration,
            **values,
        )


def stride(period: float) -> int:
    """Ticks of `period` [s] from one sample to the next: the fewest that keep HIGHEST_RATE."""
    return max(1, math.ceil(1 / (HIGHEST_RATE * period) - 1e-9))


def history_bytes(duration: float, period: float) -> int:
    """Of the signals of a run of a duration [s] with ticks of `period` [s]."""
    return 8 * len(SIGNALS) * math.ceil(duration / (stride(period) * period))


def _planned(run: "Run") -> float:
    """The duration that a record's scenario asks for [s]; what was ridden where it says none."""
    import tomllib

    return float(tomllib.loads(run.scenario).get("duration", run.ticks * run.period))
