"""A scenario from its file and what was said beside it."""

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario, read_toml

if TYPE_CHECKING:
    from bikesim.cli.run import Run

_PLAIN = "bicycle speed law path rider rig duration seed gravity period physics_step".split()


def scenario_from(options: "Run") -> Scenario:
    """The file's keys, replaced by those of the command line. Raises InputError."""
    keys = {} if options.scenario is None else read_toml(options.scenario)
    for name in _PLAIN:
        if (value := getattr(options, name)) is not None:
            keys[name] = value
    if options.speed is not None:
        keys.pop("speed_profile", None)
    if options.roll_deg is not None:
        _put(keys, ["start", "roll_deg"], options.roll_deg)
    if options.push:
        keys["pushes"] = [_push(text) for text in options.push]
    for text in options.set:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise InputError(f"--set {text}: must be KEY=VALUE, such as rider.visual_delay=0.3")
        _put(keys, [part.strip() for part in name.split(".")], _value(value.strip()))
    return _checked(keys, options.scenario)


def _checked(keys: dict[str, Any], path: Path | None) -> Scenario:
    try:
        return Scenario(**keys)
    except InputError as error:
        if path is not None and _says(read_toml(path), str(error)):
            raise InputError(f"scenario {path}: {error}") from None
        raise


def _says(keys: dict[str, Any], message: str) -> bool:
    """Whether the keys of a file are refused with the same words without the command line."""
    try:
        Scenario(**keys)
    except InputError as error:
        return str(error) == message
    return False


def _put(keys: dict[str, Any], path: list[str], value: Any) -> None:
    for name in path[:-1]:
        inner = keys.get(name, {})
        if isinstance(inner, str):
            # A rider or a rig may stand there by its name alone, a path by its kind.
            inner = {"kind" if name == "path" else "name": inner}
        keys[name] = keys = dict(inner)
    keys[path[-1]] = value


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    except RecursionError:
        raise InputError(f"--set: {text[:20]}... is nested too deeply") from None


def _push(text: str) -> dict[str, float]:
    time, _, impulse = text.partition(":")
    try:
        return {"time": float(time), "impulse": float(impulse)}
    except ValueError:
        raise InputError(
            f"--push {text}: must be TIME:IMPULSE in s and N s, such as 5:10"
        ) from None
