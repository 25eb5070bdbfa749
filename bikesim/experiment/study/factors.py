"""Factors and their levels, as an experiment's file has them."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.study.columns import RESERVED
from bikesim.experiment.study.settings import Experiment

Value = bool | int | float | str


class Setting(NamedTuple):
    """A key of the scenario, as the names of its tables and its own, and what it is set to."""

    path: tuple[str, ...]
    value: Any


class Level(NamedTuple):
    """A level of a factor: its value in the results table, and what it sets."""

    value: Value
    settings: tuple[Setting, ...]


class Factor(NamedTuple):
    """What an experiment varies. `label` is its name in a condition's."""

    name: str
    label: str
    levels: tuple[Level, ...]


def make_factors(experiment: Experiment) -> tuple[Factor, ...]:
    """The factors in the order of the file. Raises InputError."""
    names = Counter(name.rpartition(".")[2] for name in experiment.factors)
    factors = tuple(
        _factor(name, given, names[name.rpartition(".")[2]] == 1)
        for name, given in experiment.factors.items()
    )
    _check_apart(factors)
    return factors


def _factor(name: str, given: Any, alone: bool) -> Factor:
    if name in RESERVED:
        raise InputError(
            f"factors.{name}: the results have a column of that name; give it another: "
            f'my_{name} = {{ key = "{name}", values = [...] }}'
        )
    label = name.rpartition(".")[2] if alone else name
    if isinstance(given, list):
        levels = _values(f"factors.{name}", name, given)
    elif isinstance(given, dict) and set(given) == {"key", "values"}:
        levels = _values(f"factors.{name}", given["key"], given["values"])
    elif isinstance(given, dict):
        levels = _named(name, given)
    else:
        raise InputError(f"factors.{name} = {given!r}: must be a list of values, or named levels")
    if not levels:
        raise InputError(f"factors.{name}: has no level, so the experiment has 0 runs")
    values = [level.value for level in levels]
    if len(set(values)) < len(values):
        twice = next(value for value in values if values.count(value) > 1)
        raise InputError(f"factors.{name}: {twice!r} is there twice")
    return Factor(name, label, levels)


def _values(where: str, key: Any, values: Any) -> tuple[Level, ...]:
    if not isinstance(key, str) or not all(key.split(".")):
        raise InputError(f"{where}: key = {key!r}: must be a key of a scenario")
    if not isinstance(values, list):
        raise InputError(f"{where}: values = {values!r}: must be a list")
    path = tuple(key.split("."))
    columns = _alike([_column(value) for value in values])
    return tuple(Level(c, (Setting(path, v),)) for c, v in zip(columns, values, strict=True))


def _named(name: str, given: Mapping[str, Any]) -> tuple[Level, ...]:
    levels = []
    for level, settings in given.items():
        if isinstance(settings, list):
            raise InputError(
                f"factors.{name}.{level}: write the key of a scenario in quotes: "
                f'"{name}.{level}" = [...]'
            )
        if not isinstance(settings, dict):
            raise InputError(f"factors.{name}.{level} = {settings!r}: must be a table of keys")
        levels.append(Level(level, flat(settings, f"factors.{name}.{level}")))
    return tuple(levels)


def flat(settings: Mapping[str, Any], where: str) -> tuple[Setting, ...]:
    """The keys that tables set, dotted or not. Raises InputError for one that is there twice."""
    found = tuple(_leaves(settings, ()))
    paths = Counter(setting.path for setting in found)
    for path, times in paths.items():
        if times > 1:
            raise InputError(f"{where}: sets {'.'.join(path)} twice")
    return found


def _leaves(settings: Mapping[str, Any], place: tuple[str, ...]) -> Iterator[Setting]:
    for key, value in settings.items():
        path = (*place, *key.split("."))
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, path)
        else:
            yield Setting(path, value)


def _column(value: Any) -> Value:
    """What stands in the table for a value of a scenario."""
    return value if isinstance(value, Value) else json.dumps(value, separators=(",", ":"))


def _alike(values: list[Value]) -> list[Value]:
    """A column has values of one kind: numbers, or on and off, else text."""
    kinds = {type(value) for value in values}
    if kinds <= {int, float} or len(kinds) == 1:
        return values
    return [text(value) for value in values]


def text(value: Value) -> str:
    """A level as a condition's name has it."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) and float(f"{value:g}") == value else str(value)


def _check_apart(factors: Sequence[Factor]) -> None:
    """Two factors that set one key would make conditions that are not what they are called."""
    by_path: dict[tuple[str, ...], str] = {}
    for factor in factors:
        paths = {setting.path for level in factor.levels for setting in level.settings}
        for path in paths:
            if (other := by_path.setdefault(path, factor.name)) != factor.name:
                raise InputError(f"factors {other} and {factor.name} both set {'.'.join(path)}")
