"""From what a user wrote, a name, a file or "frame+rider", to the bicycle."""

import os
from collections.abc import Iterator
from pathlib import Path

from bikesim.bicycles.body import BODY_KEYS, RigidBody, with_rider
from bikesim.bicycles.files import is_there, read_text
from bikesim.bicycles.keyvalues import KeyValues, parse_key_values
from bikesim.bicycles.shipped import names, shipped_text
from bikesim.bicycles.toml_reader import bicycle_from_toml, rider_from_toml
from bikesim.errors import InputError, unknown
from bikesim.model.bicycle import Bicycle
from bikesim.model.parameters import PARAMETER_NAMES, BicycleParameters
from bikesim.textfile import located


def load_bicycle(name_or_path: str | os.PathLike[str]) -> Bicycle:
    """As `bikesim.bicycles.load`. A shipped name comes before a file, a file before a "+"."""
    text = os.fspath(name_or_path)
    if text in names():
        return _shipped(text)
    if is_there(text):
        return _bicycle_file(Path(text))
    if "+" in text:
        return _frame_with_rider(*_parts(text))
    if Path(text).suffix or Path(text).name != text:
        raise InputError(f"{text}: no such bicycle file; shipped: {', '.join(names())}")
    raise unknown("bicycle", text, names())


def _shipped(name: str) -> Bicycle:
    with located(f"shipped bicycle {name}"):
        return bicycle_from_toml(shipped_text(name), name=name, source="bikesim")


def _bicycle_file(path: Path) -> Bicycle:
    text = read_text(path)
    if path.suffix.lower() == ".toml":
        with located(str(path)):
            return bicycle_from_toml(text, name=path.stem, source=f"file {path.name}")
    read = parse_key_values(text, str(path))
    with located(str(path)):
        return Bicycle.from_parameters(
            _parameters(read),
            name=path.stem,
            source=f"file {path.name}",
            gravity=read.values.get("g", 9.81),
        )


def _parameters(read: KeyValues) -> BicycleParameters:
    missing = read.missing(PARAMETER_NAMES)
    if not missing:
        return BicycleParameters(*(read.values[name] for name in PARAMETER_NAMES))
    lacks = f"lacks {', '.join(missing)}"
    if _is_rider(read):
        raise InputError(f"has a rider's part only, {lacks}; give it after a frame: FRAME+RIDER")
    raise InputError(f"{lacks} (a bicycle has {len(PARAMETER_NAMES)} parameters)")


def _is_rider(read: KeyValues) -> bool:
    return set(BODY_KEYS) == set(PARAMETER_NAMES) & set(read.values)


def _frame_with_rider(frame_text: str, rider_text: str) -> Bicycle:
    if not rider_text.strip():
        raise InputError(f"{frame_text}+: lacks the rider's file, FRAME+RIDER")
    frame, path = load_bicycle(frame_text), Path(rider_text)
    if frame.parameters is None:
        raise InputError(f"{frame_text}: is known by its matrices only; no rider can be added")
    rider = _rider_file(path)
    with located(f"{frame_text}+{rider_text}"):
        return Bicycle.from_parameters(
            with_rider(frame.parameters, rider),
            name=f"{frame.name}+{path.stem}",
            source=f"{frame.source} with the rider of file {path.name}",
            gravity=frame.gravity,
        )


def _rider_file(path: Path) -> RigidBody:
    text = read_text(path)
    if path.suffix.lower() == ".toml":
        with located(str(path)):
            return rider_from_toml(text)
    read = parse_key_values(text, str(path))
    with located(str(path)):
        missing = read.missing(BODY_KEYS)
        if missing:
            raise InputError(f"lacks {', '.join(missing)} (a rider has {' '.join(BODY_KEYS)})")
        if not _is_rider(read):
            raise InputError(f"is a bicycle, not a rider (a rider has {' '.join(BODY_KEYS)} only)")
        return RigidBody.from_values(read.values)


def _parts(text: str) -> tuple[str, str]:
    """Frame and rider of "frame+rider", where a file's own name may hold a "+"."""
    splits = list(_splits(text))
    there = (
        (frame, rider)
        for frame, rider in splits
        if is_there(rider) and (frame in names() or is_there(frame))
    )
    return next(there, splits[0])


def _splits(text: str) -> Iterator[tuple[str, str]]:
    for place, character in enumerate(text):
        if character == "+":
            yield text[:place], text[place + 1 :]
