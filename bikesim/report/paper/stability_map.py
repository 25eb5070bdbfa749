"""What a roll PD rider can stabilise, over visual delay and arms, with haptics on and off."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.scenario import Scenario, StartSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.riding import RollGrowth, roll_growth
from bikesim.report.paper.tuning import BestRider, RollPDLoop, rider_settings
from bikesim.rider.base import Arms

SPEED = 3.5  # m/s, the paper's
ARM_INERTIA = 0.1  # kg m²
DAMPING_PER_STIFFNESS = 0.2  # s: 4 N m s/rad at 20 N m/rad
VISUAL_DELAY = 0.2  # s

# Slower than this [1/s] a ride of a check's length does not tell growth from decay.
_CLEAR = 0.1
_CHECK_ROLL_DEG = 0.001


class Condition(NamedTuple):
    """What is given of a rider: visual delay [s], arms. His gains are free."""

    delay: float
    arms: Arms


class Cell(NamedTuple):
    """The best rider under a condition, with haptics on (law paper) and off."""

    condition: Condition
    on: BestRider
    off: BestRider


@dataclass(frozen=True)
class StabilityMap:
    """Cells by row (arm stiffness) and column (delay or arm damping), rows first."""

    columns: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    cells: tuple[tuple[Cell, ...], ...]

    def growth_rates(self, law: Law) -> NDArray[np.float64]:
        """The least growth rate of each cell [1/s], shape (rows, columns)."""
        return np.array([[best(cell, law).growth_rate for cell in row] for row in self.cells])


class Check(NamedTuple):
    """A cell ridden in the virtual rig by its best rider."""

    cell: Cell
    law: Law
    roll: RollGrowth

    @property
    def agrees(self) -> bool:
        """Whether the ride did what the linear map says."""
        return self.roll.grew == (best(self.cell, self.law).growth_rate > 0)


def best(cell: Cell, law: Law) -> BestRider:
    """The best rider of a cell under a law."""
    return cell.off if law is Law.OFF else cell.on


def over_delay(
    bicycle: Bicycle, delays: Sequence[float], stiffnesses: Sequence[float], progress: Progress
) -> StabilityMap:
    """The map over visual delay [s] and arm stiffness [N m/rad], damping in proportion."""
    conditions = [
        [Condition(delay, Arms(ARM_INERTIA, DAMPING_PER_STIFFNESS * k, k)) for delay in delays]
        for k in stiffnesses
    ]
    return _solve(bicycle, tuple(delays), tuple(stiffnesses), conditions, progress)


def over_damping(
    bicycle: Bicycle, dampings: Sequence[float], stiffnesses: Sequence[float], progress: Progress
) -> StabilityMap:
    """The map over arm damping [N m s/rad] and stiffness [N m/rad] at the usual visual delay."""
    conditions = [
        [Condition(VISUAL_DELAY, Arms(ARM_INERTIA, b, k)) for b in dampings] for k in stiffnesses
    ]
    return _solve(bicycle, tuple(dampings), tuple(stiffnesses), conditions, progress)


def solve_cell(bicycle: Bicycle, condition: Condition, neighbours: Sequence[Cell] = ()) -> Cell:
    """The best riders under a condition; neighbours' gains are where the search starts."""
    found = []
    for law in (Law.PAPER, Law.OFF):
        loop = RollPDLoop(bicycle, SPEED, law, delay=condition.delay, arms=condition.arms)
        starts = [best(cell, law).gains for cell in neighbours]
        found.append(loop.best(starts) if starts else loop.best())
    return Cell(condition, *found)


def check(cell: Cell, law: Law, duration: float) -> Check | None:
    """Ride a cell in the virtual rig for `duration` [s]; None where it is marginal.

    It starts with so little roll that what grows before it dies out meets no limit of the guard.
    """
    rider = best(cell, law)
    if abs(rider.growth_rate) < _CLEAR:
        return None
    scenario = Scenario(
        speed=SPEED,
        law=law.value,
        rider=rider_settings(*cell.condition, rider.gains),
        start=StartSettings(roll_deg=_CHECK_ROLL_DEG),
        duration=duration,
    )
    return Check(cell, law, roll_growth(scenario))


def _solve(
    bicycle: Bicycle,
    columns: tuple[float, ...],
    stiffnesses: tuple[float, ...],
    conditions: Sequence[Sequence[Condition]],
    progress: Progress,
) -> StabilityMap:
    rows: list[tuple[Cell, ...]] = []
    for row in conditions:
        cells: list[Cell] = []
        for i, condition in enumerate(row):
            neighbours = [*cells[-1:], *(above[i] for above in rows[-1:])]
            cells.append(solve_cell(bicycle, condition, neighbours))
        rows.append(tuple(cells))
        progress.step("map")
    return StabilityMap(columns, stiffnesses, tuple(rows))
