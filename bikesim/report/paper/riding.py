"""Runs in the virtual rig for the paper: kept as records, or only their roll."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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


def grows(scenario: Scenario) -> bool:
    """Whether the roll of a ride without noise grows: a fall, or more of it late than early.

    Late is the last quarter of the ride, early the second: the first is the start's transient.
    For the checks of a map, of which no record is kept.
    """
    roll = _Roll()
    ending = ride_parts(build(scenario), roll)
    quarter = len(roll.values) // 4
    values = np.abs(roll.array())
    return ending.fell or bool(values[-quarter:].max() > values[quarter : 2 * quarter].max())


class _Roll:
    def __init__(self) -> None:
        self.values: list[float] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.values.append(row[_ROLL])

    def array(self) -> NDArray[np.float64]:
        return np.array(self.values)
