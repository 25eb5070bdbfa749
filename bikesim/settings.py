"""The base of everything a user sets, in TOML or on the command line: one check, one message."""

from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from bikesim.errors import InputError, unknown


class Settings(BaseModel):
    """A frozen, validated group of settings; unknown keys are refused.

    Raises InputError that names key, value and what is allowed.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise _one_line(type(self), error) from None


def _one_line(model: type[BaseModel], error: ValidationError) -> InputError:
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        *parents, key = (str(part) for part in first["loc"])
        place = f" in [{'.'.join(parents)}]" if parents else ""
        return unknown(f"key{place}", key, _fields(model, parents))
    if first["type"] == "value_error":
        return InputError(f"{where}: {first['ctx']['error']}" if where else str(first["ctx"]["error"]))
    message = first["msg"].removeprefix("Input ").replace("should be", "must be")
    return InputError(f"{where} = {first['input']!r}: {message}")


def _fields(model: type[BaseModel], parents: list[str]) -> list[str]:
    for name in parents:
        field = model.model_fields.get(name)
        inner = field.annotation if field else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            break
        model = inner
    return list(model.model_fields)
