"""Whether a run that was ridden again, alone, is the one in the table."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from bikesim.experiment.metrics import Metrics
from bikesim.experiment.study.work import Result

# What rounding can become in a long ride; a metric is given in its own unit.
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9


def rows_by_run(table: Any) -> dict[tuple[int, int], dict[str, Any]]:
    """The rows of a table of results, each by the number of its condition and its seed."""
    names = ("condition_number", "seed", "ending", "ticks", *Metrics._fields)
    rows = zip(*(table[name].tolist() for name in names), strict=True)
    return {(number, seed): dict(zip(names[2:], rest, strict=True)) for number, seed, *rest in rows}


def difference(row: Mapping[str, Any], result: Result, metrics: Metrics) -> str:
    """The first thing in which a run alone is not that of its row; empty where there is none."""
    alone = {"ticks": result.ticks, "ending": result.ending, **metrics._asdict()}
    for name, value in alone.items():
        if not _same(value, row[name]):
            return f"{name} is {_told(value)} alone and {_told(row[name])} in its batch"
    return ""


def note_of(differences: Iterable[tuple[object, str]], ridden: int) -> str:
    """One line for all runs that differ, each with how; empty where none does."""
    found = list(differences)
    if not found:
        return ""
    run, how = found[0]
    return (
        f"note: {len(found)} of {ridden} kept runs are not those of the table, the first {run}: "
        f"{how}; other machines, other code, or a rider that does not ride in a batch as he does "
        "alone"
    )


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, str):
        return a == b
    a, b = (math.nan if one is None else float(one) for one in (a, b))
    both_undefined = math.isnan(a) and math.isnan(b)
    return both_undefined or math.isclose(a, b, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)


def _told(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)
