"""What a run came to, from its record."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.record.header import Ending
from bikesim.record.reader import Run


class Summary(NamedTuple):
    """A run in a few figures; root mean squares over all its ticks, SI.

    `rms_steer` is of the bar itself; where the record has the sensors' word alone, of that.
    `fall_time` [s] is None if the bicycle did not fall; `sim_over_wall` is simulated time over
    the wall time of the loop.
    """

    record: str
    reason: str
    fell: bool
    fall_time: float | None
    ticks: int
    rms_roll: float
    rms_steer: float
    rms_feedback_torque: float
    sim_over_wall: float


def summarise(run: Run) -> Summary:
    """The summary of a record; the feedback torque is what was really sent."""
    wall = run.timing("wall_time")
    ending = run.ending or Ending("not closed: killed, or still running")
    return Summary(
        record=str(run.path),
        reason=ending.reason,
        fell=ending.fell,
        fall_time=ending.fall_time,
        ticks=run.ticks,
        rms_roll=_rms(run.channel("roll")),
        rms_steer=_rms(run.channel("true_steer" if "true_steer" in run.names else "steer")),
        rms_feedback_torque=_rms(run.channel("sent_torque")),
        sim_over_wall=run.ticks * run.period / float(wall[-1]) if wall[-1] > 0 else math.nan,
    )


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
