"""The conditions of an experiment: a grid of its factors, and those beside it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.factors import Factor, Level, Setting, Value, flat, text
from bikesim.experiment.study.reading import found, merged
from bikesim.experiment.study.settings import Experiment


class Condition(NamedTuple):
    """A scenario but for its seed, and the level of each factor, None where it has none."""

    number: int
    name: str
    values: tuple[Value | None, ...]
    scenario: Scenario


def count_conditions(experiment: Experiment, factors: Sequence[Factor]) -> int:
    """How many there are, without making them."""
    return _grid_size(experiment, factors) + len(experiment.conditions)


def make_conditions(experiment: Experiment, factors: Sequence[Factor]) -> Iterator[Condition]:
    """The grid, the last factor changing fastest, then the extra ones. Raises InputError."""
    names = set[str]()
    grid = product(*(factor.levels for factor in factors)) if _has_grid(experiment) else ()
    for number, levels in enumerate(grid, 1):
        name = _name(factors, levels)
        scenario = _grid_scenario(experiment, factors, levels, name)
        names.add(name)
        yield Condition(number, name, tuple(level.value for level in levels), scenario)
    for number, extra in enumerate(experiment.conditions, _grid_size(experiment, factors) + 1):
        if extra.name in names:
            raise InputError(f"conditions: {extra.name!r} is there twice")
        names.add(extra.name)
        settings = flat(extra.set, f"conditions {extra.name!r}")
        scenario = _scenario(experiment, settings, f"condition {extra.name!r}")
        values = tuple(_value_of(factor, scenario, experiment) for factor in factors)
        yield Condition(number, extra.name, values, scenario)


def _name(factors: Sequence[Factor], levels: Sequence[Level]) -> str:
    told = (f"{f.label}={text(level.value)}" for f, level in zip(factors, levels, strict=True))
    return ", ".join(told) or "base"


def _has_grid(experiment: Experiment) -> bool:
    return bool(experiment.factors) or not experiment.conditions


def _grid_size(experiment: Experiment, factors: Sequence[Factor]) -> int:
    return math.prod(len(f.levels) for f in factors) if _has_grid(experiment) else 0


def _grid_scenario(
    experiment: Experiment, factors: Sequence[Factor], levels: Sequence[Level], name: str
) -> Scenario:
    settings = [setting for level in levels for setting in level.settings]
    try:
        return _scenario(experiment, settings, f"condition {name!r}")
    except InputError as error:
        raise _blamed(experiment, factors, levels, str(error)) or error from None


def _blamed(
    experiment: Experiment, factors: Sequence[Factor], levels: Sequence[Level], message: str
) -> InputError | None:
    """The error of the factor that is wrong by itself, if one is."""
    for factor, level in zip(factors, levels, strict=True):
        where = f"factors.{factor.name}, level {text(level.value)}"
        try:
            _scenario(experiment, level.settings, where)
        except InputError as error:
            if str(error).partition(": ")[2] == message.partition(": ")[2]:
                return error
    return None


def _scenario(experiment: Experiment, settings: Sequence[Setting], where: str) -> Scenario:
    keys: Mapping[str, Any] = experiment.scenario
    folder = _folder(experiment)
    # A whole table or name first, then what is set in it.
    for setting in sorted(settings, key=lambda one: len(one.path)):
        keys = merged(keys, _nested(setting, folder))
    for setting in settings:
        if setting.path == ("seed",):
            raise InputError(f"{where}: seed: an experiment has seeds, beside its factors")
    try:
        return Scenario(**keys)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _nested(setting: Setting, folder: Path | None) -> dict[str, Any]:
    value: Any = found(setting.value, folder)
    for name in reversed(setting.path):
        value = {name: value}
    return value


def _value_of(factor: Factor, scenario: Scenario, experiment: Experiment) -> Value | None:
    """The level of a factor that a scenario has, whoever gave it that."""
    folder = _folder(experiment)
    fitting = [
        level
        for level in factor.levels
        if all(_get(scenario, one.path) == found(one.value, folder) for one in level.settings)
    ]
    # A level that sets nothing fits everything, but not best.
    best = max(fitting, key=lambda level: len(level.settings), default=None)
    return None if best is None else best.value


def _get(scenario: Scenario, path: Sequence[str]) -> Any:
    value: Any = scenario
    for name in path:
        value = getattr(value, name, None)
    # A rider, a rig or a path may stand in a file by its name alone.
    return getattr(value, "name", getattr(value, "kind", value))


def _folder(experiment: Experiment) -> Path | None:
    return Path(experiment.folder) if experiment.folder else None
