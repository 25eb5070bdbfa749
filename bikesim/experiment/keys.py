"""Every key of a scenario, for help and documentation."""

from collections.abc import Iterator
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.scenario import Push, Scenario


class Key(NamedTuple):
    """A key as it is written in TOML or after --set, its default, and what it means."""

    key: str
    default: str
    meaning: str


def scenario_keys() -> list[Key]:
    """The keys in their order; a table's keys as table.key."""
    return [
        *_keys(Scenario, ""),
        *_keys(Push, "pushes."),
        *_keys(Disturbance, "disturbances."),
    ]


def _keys(model: type[BaseModel], prefix: str) -> Iterator[Key]:
    for name, field in model.model_fields.items():
        if (table := _table(field.annotation)) is not None:
            yield from _keys(table, f"{prefix}{name}.")
            continue
        yield Key(f"{prefix}{name}", _told(field, prefix), field.description or "")


def _table(kind: Any) -> type[BaseModel] | None:
    """The model of a key that is a table, also of one that may be absent."""
    kinds = [one for one in (get_args(kind) or (kind,)) if one is not type(None)]
    only = kinds[0] if len(kinds) == 1 else None
    return only if isinstance(only, type) and issubclass(only, BaseModel) else None


def _told(field: FieldInfo, prefix: str) -> str:
    if field.is_required():
        return "must be given"
    if field.default in (None, (), ""):
        # A description that says what stands for nothing has said it.
        if "default:" in (field.description or ""):
            return ""
        return "that of the rider named" if prefix == "rider." else "none"
    # As TOML has it.
    return str(field.default).lower() if isinstance(field.default, bool) else str(field.default)
