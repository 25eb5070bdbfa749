"""Runs in the virtual rig for the paper: kept as records, or only their roll."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from bikesim.experiment.run import build, ride_parts, run
from bikesim.experiment.scenario import Scenario
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.reader import Run, open_run

_ROLL = next(i for i, channel in enumerate(TICK_CHANNELS) if channel.name == "roll")


def recorded(scenario: Scenario, path: Path) -> Run:
    """Ride and record in `path`; gives the record."""
    run(build(scenario), path)
    return open_run(path)


def fell(record: Run) -> bool:
    """Whether a complete record ends with a fall."""
    return record.ending is not None and record.ending.fell


class RollGrowth(NamedTuple):
    """Whether the roll of a ride without noise grows, and its peak over that at the start."""

    grew: bool
    peak_ratio: float


def roll_growth(scenario: Scenario) -> RollGrowth:
    """Ride without a record; the roll grew if it fell, or peaks higher in the last quarter.

    That is than in the quarter before: near the limit of stability a transient rises for more than
    10 s before it dies out.
    """
    roll = _Roll()
    ending = ride_parts(build(scenario), roll)
    values = np.abs(np.array(roll.values))
    quarter = len(values) // 4
    before, last = values[-2 * quarter : -quarter].max(), values[-quarter:].max()
    return RollGrowth(ending.fell or bool(last > before), float(values.max() / values[0]))


class _Roll:
    def __init__(self) -> None:
        self.values: list[float] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.values.append(row[_ROLL])
