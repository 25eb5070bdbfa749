"""A torque by time, from a text file."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from bikesim.errors import InputError
from bikesim.textfile import located, read_text

_LARGEST = 100_000_000  # bytes: an hour at 1 kHz
FEWEST = 2

Sample = tuple[float, float]


def read_samples(file: Path) -> tuple[Sample, ...]:
    """The columns time [s] and torque [N m] of a text file, separated by ; , tab or blanks.

    Its first line may name the columns, as that of an exported run does; without names they are
    the first two. Empty lines and those that begin with # are left out. Raises InputError.
    """
    with located(f"rider.script.file {file}"):
        lines = [
            (number, _words(line))
            for number, line in enumerate(read_text(file, "torque", _LARGEST).splitlines(), 1)
            if line.strip() and not line.lstrip().startswith("#")
        ]
        columns = (0, 1)
        if lines and _number(lines[0][1][0]) is None:
            columns = _columns(lines.pop(0)[1])
        samples = tuple(_sample(number, words, columns) for number, words in lines)
        check_samples(samples)
        return samples


def check_samples(samples: Sequence[Sample]) -> None:
    """Raises InputError for samples that are no torque by time."""
    if len(samples) < FEWEST:
        raise InputError(f"{len(samples)} samples: must be at least {FEWEST}")
    for time, torque in samples:
        if not math.isfinite(time) or not math.isfinite(torque):
            raise InputError(f"sample {(time, torque)}: time and torque must be numbers")
    for (earlier, _), (later, _) in pairwise(samples):
        if later <= earlier:
            raise InputError(
                f"times must rise from sample to sample, but {later} follows {earlier}"
            )


def _words(line: str) -> list[str]:
    separator = next((one for one in ";,\t" if one in line), None)
    return [word.strip() for word in line.split(separator)]


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _columns(header: Sequence[str]) -> tuple[int, int]:
    """Where time and torque are: columns named so, the rider's torque before any other."""
    names = [word.strip("\"'").lower() for word in header]
    time = _first(names, r"time(\W|_|$)")
    torque = _first(names, r"rider_torque(\W|_|$)")
    torque = _first(names, r"torque(\W|_|$)") if torque is None else torque
    if time is None or torque is None:
        missing = "time" if time is None else "torque"
        raise InputError(f"no column named {missing}; there are: {', '.join(names)[:200]}")
    return time, torque


def _first(names: Sequence[str], pattern: str) -> int | None:
    return next((i for i, name in enumerate(names) if re.match(pattern, name)), None)


def _sample(number: int, words: Sequence[str], columns: tuple[int, int]) -> Sample:
    if len(words) <= max(columns):
        raise InputError(f"line {number}: {len(words)} columns, time and torque are needed")
    time, torque = (_finite(number, words[column]) for column in columns)
    return time, torque


def _finite(number: int, word: str) -> float:
    value = _number(word)
    if value is None or not math.isfinite(value):
        raise InputError(f"line {number}: {word[:40]!r} must be a number")
    return value
