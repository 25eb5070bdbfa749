"""The data of a report, from the folder of an experiment's results."""

import re
from pathlib import Path

from bikesim.experiment.keys import scenario_keys
from bikesim.experiment.study import grid
from bikesim.experiment.study.manifest import EXPERIMENT, Manifest
from bikesim.experiment.study.results import Results, read_results
from bikesim.report.experiment.comparisons import Asked, Named, comparisons
from bikesim.report.experiment.data import Condition, Data, Factor, Kept


def read_data(folder: Path) -> Data:
    """What a folder holds, also of an experiment that is not done. Raises InputError."""
    results, manifest = read_results(folder), Manifest.read(folder)
    experiment, table = results.study.experiment, results.table
    factors = tuple(_factor(one) for one in results.study.factors)
    there = set(table["condition"])
    beside = {one.name for one in experiment.conditions}
    conditions = tuple(
        Condition(one.name, one.values, one.name in beside)
        for one in results.study.conditions
        if one.name in there
    )
    asked = [
        Asked(one.factor, *one.levels) if one.factor else Named(one.of, one.against)
        for one in experiment.report.contrasts
    ]
    return Data(
        title=experiment.title or folder.resolve().name,
        description=experiment.description,
        factors=factors,
        conditions=conditions,
        table=table,
        metrics=experiment.report.metrics,
        comparisons=comparisons(asked, factors, conditions),
        planned=results.planned,
        facts=_facts(results, manifest),
        kept=_kept(results),
        toml=(folder / EXPERIMENT).read_text("utf-8"),
    )


def _factor(one: grid.Factor) -> Factor:
    """Its unit is that of the key that it sets, where it is one key."""
    keys = {".".join(setting.path) for level in one.levels for setting in level.settings}
    key = keys.pop() if len(keys) == 1 else ""
    values = tuple(level.value for level in one.levels)
    label = one.label.replace("_", " ")
    if key.endswith("_deg"):
        label = label.removesuffix(" deg")
    factor = Factor(one.name, label, _unit(key), values)
    return factor if factor.numeric else factor._replace(unit="")


def _unit(key: str) -> str:
    """The unit in the description of a scenario's key, where there is one."""
    meaning = next((one.meaning for one in scenario_keys() if one.key == key), "")
    found = re.search(r"\[([^\]]+)\]", meaning)
    return found[1] if found else ""


def _kept(results: Results) -> tuple[Kept, ...]:
    table = results.table
    rows = zip(*(table[name].tolist() for name in ("condition", "seed", "record", "video")),
               strict=True)  # fmt: skip
    return tuple(
        Kept(condition, seed, record, video if isinstance(video, str) else None)
        for condition, seed, record, video in rows
        if isinstance(record, str)
    )


def _facts(results: Results, manifest: Manifest) -> tuple[tuple[str, str], ...]:
    seconds = sum(results.table["seconds"].tolist())
    workers = len(set(results.table["worker"].tolist()))
    return (
        *results.versions._asdict().items(),
        ("source", manifest.commit or "an installed release"),
        ("begun", manifest.created),
        ("computed by", f"{workers} worker{'s' if workers > 1 else ''}, {seconds:.0f} s in all"),
        ("conditions and seeds (SHA-256)", manifest.digest),
    )
