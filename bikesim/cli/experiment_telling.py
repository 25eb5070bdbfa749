"""What is said of an experiment: before it, and what came of it."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bikesim.cli.output import table_lines

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

    from bikesim.experiment.metric_table import Metric
    from bikesim.experiment.study.plan import Batch, Study
    from bikesim.experiment.study.results import Results

_MOST_ROWS = 60
_LONG = 3e6  # ticks of runs: some ten seconds


def plan_told(study: "Study", batches: "Sequence[Batch]", workers: int, seconds: float) -> str:
    """An experiment that was not begun."""
    from bikesim.experiment.study.estimate import told

    rows = [
        [condition.name, f"{condition.scenario.duration:g}", condition.scenario.rider.name]
        for condition in study.conditions[:_MOST_ROWS]
    ]
    lines = [
        *([study.experiment.title] if study.experiment.title else []),
        *table_lines(["condition", "s", "rider"], rows),
        *_more(len(study.conditions)),
        f"{_size(study)}: {study.runs} runs in {_count(len(batches), 'batch')}",
        f"about {told(seconds)} on {_count(workers, 'worker')}, less where runs end early",
    ]
    return "\n".join(lines)


def plan_json(
    study: "Study", batches: "Sequence[Batch]", workers: int, seconds: float
) -> dict[str, Any]:
    """The keys of `bikesim experiment --dry-run --json`."""
    return {
        "title": study.experiment.title,
        "conditions": [
            {"number": one.number, "name": one.name, "factors": _levels(study, one.values)}
            for one in study.conditions
        ],
        "seeds": len(study.experiment.seeds),
        "runs": study.runs,
        "batches": len(batches),
        "workers": workers,
        "estimate_s": seconds,
    }


def announcement(study: "Study", done: int, batches: "Sequence[Batch]", workers: int) -> str:
    """How much is to come, and how long it takes."""
    from bikesim.experiment.study.estimate import seconds_for, told

    ticks = sum(study.condition(run.condition).scenario.ticks for b in batches for run in b.runs)
    seconds = seconds_for(study, batches, workers) if ticks > _LONG else 0.0
    left = f"{study.runs - done} of {study.runs}" if done else f"{study.runs}"
    return (
        f"{_size(study)}: {left} runs in {_count(len(batches), 'batch')} on "
        f"{_count(workers, 'worker')}: {told(seconds)} at most"
    )


def results_told(results: "Results", folder: Path, report: Path | None) -> str:
    """A line a condition, and where all of it lies."""
    metrics = _primary(results)
    rows = [
        [
            row["condition"],
            str(row["runs"]),
            str(row["falls"]),
            f"{100 * row['fall_rate_low']:.0f} to {100 * row['fall_rate_high']:.0f}",
            *(_number(row["medians"][m.name] * m.factor) for m in metrics),
        ]
        for row in _rows(results)
    ]
    units = [f"{_plain(m)} [{m.shown_unit}]" if m.shown_unit else _plain(m) for m in metrics]
    header = ["condition", "runs", "falls", "% (95 %)", *units]
    lines = [
        *([results.study.experiment.title] if results.study.experiment.title else []),
        *table_lines(header, rows[:_MOST_ROWS]),
        *_more(len(rows)),
        _which_medians([m.name for m in metrics]),
        *_faults(results.table),
        f"results {folder / 'results.parquet'}, .csv",
        *([] if report is None else [f"report  {report}"]),
    ]
    return "\n".join(lines)


def _which_medians(names: list[str]) -> str:
    from bikesim.experiment.metric_table import FALL_TIME, OF_ALL_RUNS
    from bikesim.report.experiment.words import listed

    of_all = [name for name in names if name in OF_ALL_RUNS and name != FALL_TIME]
    told = ["medians of the runs that came to their end"] if set(names) - set(OF_ALL_RUNS) else []
    told += [f"{listed(of_all)}: median of all runs"] if of_all else []
    told += ["fall time: median by Kaplan-Meier, of all runs"] if FALL_TIME in names else []
    return "; ".join([*told, "falls with Wilson's interval"])


def results_json(results: "Results", folder: Path, report: Path | None) -> dict[str, Any]:
    """The keys of `bikesim experiment --json`."""
    return {
        "title": results.study.experiment.title,
        "runs": len(results.table),
        "runs_planned": results.planned,
        "conditions": list(_rows(results)),
        "faults": _faults(results.table),
        "results": str(folder / "results.parquet"),
        "report": None if report is None else str(report),
    }


def _rows(results: "Results") -> list[dict[str, Any]]:
    import numpy as np

    from bikesim.experiment.metric_table import FALL_TIME, OF_ALL_RUNS, WHOLE
    from bikesim.report.experiment.rates import wilson
    from bikesim.report.experiment.survival import kaplan_meier, ridden

    names = [metric.name for metric in _primary(results)]
    numbers = results.table["condition_number"].to_numpy()  # they rise from row to row
    columns = {name: results.table[name].to_numpy(np.float64) for name in [*OF_ALL_RUNS, *names]}
    for name in names:
        if name not in OF_ALL_RUNS:
            columns[name] = np.where(results.table["ending"] == WHOLE, columns[name], np.nan)
    rows = []
    for condition in results.study.conditions:
        first, last = np.searchsorted(numbers, [condition.number, condition.number + 1])
        if first == last:
            continue
        medians = {name: _median(columns[name][first:last]) for name in names}
        if FALL_TIME in medians:
            until = ridden(*(columns[name][first:last] for name in ("duration", FALL_TIME)))
            medians[FALL_TIME] = kaplan_meier(until, columns["fell"][first:last] > 0).median
        rate = wilson(int(columns["fell"][first:last].sum()), int(last - first))
        rows.append(
            {
                "condition": condition.name,
                "factors": _levels(results.study, condition.values),
                "runs": rate.runs,
                "falls": rate.events,
                "fall_rate_low": rate.low,
                "fall_rate_high": rate.high,
                "medians": medians,
            }
        )
    return rows


def _median(values: "NDArray[np.float64]") -> float:
    """Of the runs in which it is defined."""
    import numpy as np

    defined = values[np.isfinite(values)]
    return float(np.median(defined)) if len(defined) else math.nan


def _primary(results: "Results") -> "list[Metric]":
    from bikesim.experiment.metric_table import METRICS

    by_name = {metric.name: metric for metric in METRICS}
    return [by_name[name] for name in results.study.experiment.report.metrics]


def _faults(table: "pd.DataFrame") -> list[str]:
    """Runs that ended by neither falling nor lasting."""
    faults = table[table["ending"].str.startswith("fault")]
    if faults.empty:
        return []
    first = faults.iloc[0]
    return [f"{_count(len(faults), 'run')} ended in a {first['ending']} (run {first['run']})"]


def _levels(study: "Study", values: Sequence[Any]) -> dict[str, Any]:
    return {factor.name: value for factor, value in zip(study.factors, values, strict=True)}


def _size(study: "Study") -> str:
    conditions = _count(len(study.conditions), "condition")
    return f"{conditions} x {_count(len(study.experiment.seeds), 'seed')}"


def _count(number: int, what: str) -> str:
    plural = f"{what}es" if what.endswith("ch") else f"{what}s"
    return f"{number} {what if number == 1 else plural}"


def _more(rows: int) -> list[str]:
    return [f"... and {rows - _MOST_ROWS} more"] if rows > _MOST_ROWS else []


def _plain(metric: "Metric") -> str:
    return metric.name.removesuffix("_rms").replace("_", " ")


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "-"
