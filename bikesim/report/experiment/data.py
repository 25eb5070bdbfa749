"""What a report is about: the table of runs, and what was asked of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.metric_table import WHOLE

if TYPE_CHECKING:
    import pandas as pd


class Factor(NamedTuple):
    """What differs between conditions: a column of the table, and its levels in their order.

    `label` is what it is called on the page, `unit` that of its levels, empty without one.
    """

    name: str
    label: str
    unit: str
    levels: tuple[Any, ...]

    @property
    def numeric(self) -> bool:
        """Whether its levels can lie on an axis."""
        return all(isinstance(v, int | float) and not isinstance(v, bool) for v in self.levels)

    @property
    def axis(self) -> str:
        """Its name beside an axis or above a column."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def at(self, level: Any) -> str:
        """A level of it, such as: speed 3.5 m/s."""
        return f"{self.label} {shown(level)} {self.unit}".rstrip()


class Condition(NamedTuple):
    """One cell of the grid, or one `beside` it: its name, and the level of each factor."""

    name: str
    levels: tuple[Any, ...]
    beside: bool = False


class Comparison(NamedTuple):
    """Two conditions to be held against each other: the second is read as against the first."""

    name: str
    first: str
    second: str


class Kept(NamedTuple):
    """A run whose record was kept; paths from the results folder, `video` None without one."""

    condition: str
    seed: int
    record: str
    video: str | None


@dataclass(frozen=True, eq=False)
class Data:
    """An experiment that was run. `table` has a row a run: condition, seed, factors, metrics.

    `metrics` are the names of those that were asked about, `planned` the runs that were asked
    for; `facts` pairs of what is told at the page's end, such as versions; `toml` the experiment.
    """

    title: str
    description: str
    factors: tuple[Factor, ...]
    conditions: tuple[Condition, ...]
    table: "pd.DataFrame"
    metrics: tuple[str, ...]
    comparisons: tuple[Comparison, ...]
    planned: int
    facts: tuple[tuple[str, str], ...] = ()
    kept: tuple[Kept, ...] = ()
    toml: str = ""

    def column(self, name: str) -> NDArray[Any]:
        """A column of the table."""
        return self.table[name].to_numpy()

    def values(self, condition: str, column: str) -> NDArray[np.float64]:
        """A column of a condition's runs, in order of their seeds."""
        return self.column(column)[self._rows(condition)].astype(np.float64)

    def whole(self, condition: str) -> NDArray[np.bool_]:
        """Which of a condition's runs came to their end, without a fall or a fault."""
        return self.column("ending")[self._rows(condition)] == WHOLE

    def paired(self, comparison: Comparison, columns: Sequence[str]) -> NDArray[np.float64]:
        """(2, 1 + k, m): whether whole, and columns, of both over the m seeds that both have."""
        halves = (comparison.first, comparison.second)
        # As whole numbers: above 2^53 neighbours are one as floats.
        seeds = [self.column("seed")[self._rows(name)] for name in halves]
        _, *both = np.intersect1d(*seeds, assume_unique=True, return_indices=True)
        return np.array(
            [
                [self.whole(name)[at], *(self.values(name, column)[at] for column in columns)]
                for name, at in zip(halves, both, strict=True)
            ]
        )

    def _rows(self, condition: str) -> NDArray[np.intp]:
        """Of a condition, in order of the seeds."""
        rows = np.flatnonzero(self.column("condition") == condition)
        return rows[np.argsort(self.column("seed")[rows], kind="stable")]


def shown(level: Any) -> str:
    """A level as text; an extra condition may have none of the levels."""
    if level is None:
        return "other"
    if isinstance(level, bool):
        return "on" if level else "off"
    return f"{level:g}" if isinstance(level, float) else str(level)
