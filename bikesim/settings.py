"""The base of everything a user sets, in TOML or on the command line: one check, one message."""

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, ValidationError

from bikesim.errors import InputError, unknown


class Settings(BaseModel):
    """A frozen, validated group of settings; unknown keys are refused.

    Raises InputError that names key, value and what is allowed. `table` is the group's place in
    a scenario, for the message.
    """

    table: ClassVar[str] = ""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise _one_line(type(self), error) from None


def _one_line(model: type[Settings], error: ValidationError) -> InputError:
    first = error.errors()[0]
    *inside, key = (model.table, *(str(part) for part in first["loc"])) if first["loc"] else ("",)
    where = ".".join(part for part in (*inside, key) if part)
    match first["type"]:
        case "extra_forbidden":
            place = f" in [{model.table}]" if model.table else ""
            return unknown(f"key{place}", key, model.model_fields)
        case "value_error":
            said = str(first.get("ctx", {})["error"])
            return InputError(f"{where}: {said}" if where else said)
        case "missing":
            return InputError(f"{where}: must be given")
    message = first["msg"].removeprefix("Input ").replace("should be", "must be")
    return InputError(f"{where} = {first['input']!r}: {message}")
