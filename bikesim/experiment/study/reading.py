"""An experiment's file, with the scenario that it builds on."""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from bikesim import textfile
from bikesim.errors import InputError, unknown
from bikesim.experiment.files import beside
from bikesim.experiment.scenario import read_toml
from bikesim.experiment.study.settings import Experiment


def shipped_names() -> tuple[str, ...]:
    """The names of the experiments that ship with bikesim, in alphabetical order."""
    folder = files("bikesim.experiment") / "shipped"
    listing = (entry.name for entry in folder.iterdir()) if folder.is_dir() else ()
    return tuple(sorted(name.removesuffix(".toml") for name in listing if name.endswith(".toml")))


def read_experiment(name: str) -> Experiment:
    """An experiment by the path of its file, or by its name. Raises InputError."""
    path = Path(name)
    # A folder of results is called as its experiment is.
    if path.suffix != ".toml" and not path.is_file():
        if name not in shipped_names():
            raise unknown("experiment", name, shipped_names())
        text = (files("bikesim.experiment") / "shipped" / f"{name}.toml").read_text("utf-8")
        return parse_experiment(text, None)
    with textfile.located(f"experiment {path}"):
        return parse_experiment(textfile.read_text(path, "experiment"), path.parent)


def parse_experiment(text: str, folder: Path | None) -> Experiment:
    """An experiment's TOML text; the files that it names are sought in `folder` first."""
    keys = textfile.parse_toml(text)
    folder = folder if "folder" not in keys else Path(str(keys["folder"]))
    if folder is not None:
        keys["folder"] = str(folder.absolute())
        if "base" in keys:
            keys = with_base(keys, folder)
    experiment = Experiment(**keys)
    return experiment.model_copy(update={"scenario": found(experiment.scenario, folder)})


def with_base(keys: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The keys without `base`: the scenario that it names is part of them."""
    base, over = keys["base"], keys.get("scenario", {})
    if not isinstance(base, str):
        raise InputError(f"base = {base!r}: must be the name of a scenario file")
    if not isinstance(over, dict):
        raise InputError(f"scenario = {over!r}: must be a table")
    path = folder / base
    under = found(read_toml(path), path.parent)
    under.pop("seed", None)
    kept = {key: value for key, value in keys.items() if key != "base"}
    return {**kept, "scenario": merged(under, over)}


def found(value: Any, folder: Path | None) -> Any:
    """What keys are set to, with the whole path of each file that is there.

    It is sought in `folder`, then in the current one, and with its whole path found from anywhere.
    A rider's file that is nowhere is one that was in `folder`: his results may be there still.
    """
    here = Path.cwd()
    if folder is None:
        return beside(value, here)
    folder = folder.absolute()
    return _riders_in(beside(beside(value, folder), here), folder)


def _riders_in(value: Any, folder: Path) -> Any:
    if isinstance(value, Mapping):
        return {key: _riders_in(one, folder) for key, one in value.items()}
    if isinstance(value, list):
        return [_riders_in(one, folder) for one in value]
    file, colon, name = value.rpartition(":") if isinstance(value, str) else ("", "", "")
    return f"{folder / file}{colon}{name}" if file.endswith(".py") and name else value


def merged(under: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of both, tables key by key; whatever else is in `over` replaces."""
    both = dict(under)
    for key, value in over.items():
        before = both.get(key)
        if isinstance(value, Mapping) and isinstance(before, str):
            before = {"name": before}  # a rider or a rig by its name alone
        both[key] = (
            merged(before if isinstance(before, Mapping) else {}, value)
            if isinstance(value, Mapping)
            else value
        )
    return both
