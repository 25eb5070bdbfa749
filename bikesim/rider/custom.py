"""A rider of the user's own: a class in a file or an installed package."""

import importlib
import importlib.util
import inspect
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import ModuleType

from bikesim.errors import InputError, unknown
from bikesim.model.real import Real
from bikesim.rider.base import Brain, Setting
from bikesim.rider.figures import each_of, figure
from bikesim.rider.watched import OneByOne, Watched, WatchedMany, refused

Figures = Mapping[str, float]


def load_class(name: str) -> type:
    """The class of FILE.py:CLASS, from the current folder, or of package.module:CLASS.

    A file is read anew when it has changed. Raises InputError, whatever the file raises.
    """
    place, _, class_name = name.rpartition(":")
    module = _from_file(name, place) if place.endswith(".py") else _from_package(name, place)
    found = getattr(module, class_name, None)
    if found is None:
        classes = [key for key, value in vars(module).items() if hasattr(value, "intend")]
        if not classes:
            raise InputError(f"rider {name}: {place} has no class with a method intend")
        raise unknown(f"class in {place}", class_name, classes)
    if not isinstance(found, type) or not callable(getattr(found, "intend", None)):
        raise InputError(
            f"rider {name}: must be a class with a method intend(steer, steer_rate, seen)"
        )
    return found


def class_figures(name: str) -> dict[str, float]:
    """A rider's figures with their defaults: keywords of his class whose defaults are numbers."""
    return _figures(name, load_class(name))


def custom_brain(name: str, given: Sequence[Figures], setting: Setting, *, many: bool) -> Brain:
    """The user's rider with the figures that were `given`, of each rider of a batch or of the one.

    What his class does wrong ends in an InputError of one line, which says when.
    """
    kind = load_class(name)
    known = _figures(name, kind)
    for figures in given:
        _check(name, figures, known)
    if not many:
        return Watched(name, _made(name, kind, setting, given[0]), setting.step)
    if getattr(kind, "batch", True) is False:
        return _one_by_one(name, kind, given, setting)
    keys = [key for key in known if any(key in figures for figures in given)]
    of_all = {
        key: figure(f"rider.figures.{key}", [one.get(key, known[key]) for one in given])
        for key in keys
    }
    return WatchedMany(name, _made(name, kind, setting, of_all), setting.step, len(given))


def _one_by_one(name: str, kind: type, given: Sequence[Figures], setting: Setting) -> Brain:
    speeds, previews = (each_of(len(given), one) for one in (setting.speed, setting.preview))
    brains = [
        _made(name, kind, replace(setting, speed=speed, preview=preview), figures)
        for figures, speed, preview in zip(given, speeds, previews, strict=True)
    ]
    return OneByOne([Watched(name, brain, setting.step) for brain in brains])


def _made(name: str, kind: type, setting: Setting, figures: Mapping[str, Real]) -> Brain:
    with refused(name, "when made"):
        return kind(setting, **figures)


def _check(name: str, figures: Figures, known: Figures) -> None:
    for key, value in figures.items():
        if key not in known:
            has = ", ".join(known) or "none"
            raise InputError(
                f"rider.figures.{key} = {value:g}: rider {name} has no such figure; it has: {has}"
            )


def _figures(name: str, kind: type) -> dict[str, float]:
    try:
        taken = list(inspect.signature(kind).parameters.values())[1:]
    except (TypeError, ValueError):
        taken = []
    for one in taken:
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD):
            raise InputError(
                f"rider {name}: {one.name} of its __init__ must have a default, a number"
            )
    return {
        one.name: float(one.default)
        for one in taken
        if isinstance(one.default, float | int) and not isinstance(one.default, bool)
    }


def _from_package(name: str, place: str) -> ModuleType:
    with refused(name, "when imported"):
        try:
            return importlib.import_module(place)
        except ModuleNotFoundError as error:
            if error.name is None or not f"{place}.".startswith(f"{error.name}."):
                raise
            raise InputError(
                f"rider {name}: there is no module {error.name}; a file is named as in "
                f"my_rider.py:MyRider"
            ) from None


def _from_file(name: str, place: str) -> ModuleType:
    file = Path(place).resolve()
    if not file.is_file():
        raise InputError(f"rider {name}: there is no file {place} (from {Path.cwd()})")
    with refused(name, "when imported"):
        return _read(file, file.stat().st_mtime_ns)


@lru_cache(maxsize=64)
def _read(file: Path, changed: int) -> ModuleType:
    del changed
    # A name that no other module has, under which what it defines finds its module again.
    name = f"bikesim_rider_{file.stem}_{abs(hash(str(file)))}"
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    with _found_beside(file.parent):
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            raise
    return module


@contextmanager
def _found_beside(folder: Path) -> Iterator[None]:
    """What a file imports may lie beside it, as if the file were run."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))
