"""The base of everything a user sets, in TOML or on the command line: one check, one message."""

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, ValidationError

from bikesim.errors import InputError, unknown


class Settings(BaseModel):
    """A frozen, validated group of settings; unknown keys are refused, and text for numbers.

    Raises InputError that names key, value and what is allowed. `table` is the group's place in
    a scenario, for the message.
    """

    table: ClassVar[str] = ""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise _one_line(type(self), error) from None


def of_kind(
    given: dict[str, Any], model: type[Settings], kinds: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    """What is given of a group that has a `kind`, with the figures of that kind in its place.

    Raises InputError for a kind that is none and for figures that only another kind has.
    """
    kind = given["kind"]
    if kind not in kinds:
        raise unknown(f"{model.table}.kind", kind, kinds)
    for key, value in given.items():
        if key in model.model_fields and key not in ("kind", *kinds[kind]):
            raise InputError(
                f"{model.table}.{key} = {_shown(value)}: kind {kind} has no such figure; "
                f"it has: {', '.join(kinds[kind]) or 'none'}"
            )
    return {**kinds[kind], **given}


def _one_line(model: type[Settings], error: ValidationError) -> InputError:
    errors = error.errors()
    # A key that is misspelt is missing too, but that is not what is wrong with it.
    misspelt = (one for one in errors if one["type"] == "extra_forbidden")
    first = next(misspelt, errors[0])
    place = tuple(str(part) for part in first["loc"])
    where = ".".join(part for part in (model.table, *place) if part)
    match first["type"]:
        case "extra_forbidden":
            model = _innermost(model, place[:-1])
            kind = f"key of [{model.table}]" if model.table else "key"
            return unknown(kind, place[-1], model.model_fields)
        case "value_error":
            said = first["msg"].removeprefix("Value error, ")
            return InputError(f"{where}: {said}" if place else said)
        case "missing":
            return InputError(f"{where}: must be given")
    return InputError(f"{where} = {_shown(first['input'])}: must be {_allowed(model, first)}")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _allowed(model: type[Settings], error: Mapping[str, Any]) -> str:
    kind = error["type"]
    if kind in _BOUNDS:
        (key, *deeper), told = error["loc"], error["ctx"]
        return _between(told if deeper else _bounds_of(model, key) or told)
    if kind in ("too_long", "too_short"):
        context = error["ctx"]
        return f"a list of {context.get('max_length', context.get('min_length'))}"
    if kind == "model_type" and error["loc"][-1:] in (("rider",), ("rig",), ("path",)):
        return "a name or a table"
    return _KINDS.get(kind) or error["msg"].removeprefix("Input should be ")


_KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "text",
    "tuple_type": "a list",
    "model_type": "a table",
    "dict_type": "a table",
}
_BOUNDS = {
    "greater_than_equal": ("ge", "minimum", "at least"),
    "greater_than": ("gt", "exclusiveMinimum", "above"),
    "less_than_equal": ("le", "maximum", "at most"),
    "less_than": ("lt", "exclusiveMaximum", "below"),
}


def _innermost(model: type[Settings], place: tuple[str, ...]) -> type[Settings]:
    """The model of the table at a place."""
    for part in place:
        field = model.model_fields.get(part)
        kind = None if field is None else field.annotation
        if isinstance(kind, type) and issubclass(kind, Settings):
            model = kind
    return model


def _bounds_of(model: type[Settings], key: str | int) -> dict[str, float]:
    """All bounds of a number, by their short names."""
    described = model.model_json_schema()["properties"][key]
    for kind in (described, *described.get("anyOf", ())):
        found = {short: kind[long] for short, long, _ in _BOUNDS.values() if long in kind}
        if found:
            return found
    return {}


def _between(bounds: Mapping[str, float]) -> str:
    words = (f"{word} {bounds[short]:g}" for short, _, word in _BOUNDS.values() if short in bounds)
    return " and ".join(words)
