"""Bicycle files of `key = value` lines, with or without uncertainties.

`key=value` is written by HumanControl (`*Par.txt`), `key = value+/-uncertainty` by
BicycleParameters (`*Benchmark.txt`); both name the parameters as [M07] does.
"""

import math
import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from bikesim.errors import InputError

_LINE = re.compile(r"(?P<key>[A-Za-z]\w*)\s*=\s*(?P<value>.*?)\s*(\+/-\s*(?P<spread>.*))?")
_PI_PART = re.compile(r"pi\s*/\s*(\d+)")  # HumanControl's BenchmarkPar.txt: lam=pi/10


class KeyValues(NamedTuple):
    """What such a file says: nominal values, and the standard uncertainties it gives [SI]."""

    values: Mapping[str, float]
    uncertainties: Mapping[str, float]

    def missing(self, names: Iterable[str]) -> tuple[str, ...]:
        """Those of `names` that the file lacks."""
        return tuple(name for name in names if name not in self.values)


def parse_key_values(text: str, where: str) -> KeyValues:
    """The values of a file's text; blank lines and lines that start with # or % are passed over.

    Keys that belong to no parameter are kept: these files carry more than the 25 (a speed, the
    split fork and handlebar, points where a force acts). Raises InputError naming `where` and
    the line for what is not `key = value`, not a finite number or given twice.
    """
    values: dict[str, float] = {}
    uncertainties: dict[str, float] = {}
    first: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith(("#", "%")):
            continue
        at = f"{where}, line {number}"
        match = _LINE.fullmatch(line.strip())
        if match is None:
            raise InputError(f"{at}: {line.strip()[:60]!r} is not `key = value`")
        key, spread = match["key"], match["spread"]
        if key in first:
            raise InputError(f"{at}: {key} is given twice (first in line {first[key]})")
        first[key] = number
        values[key] = _finite(match["value"], key, at)
        if spread is not None:
            uncertainties[key] = _finite(spread, f"uncertainty of {key}", at)
    return KeyValues(values, uncertainties)


def _finite(text: str, what: str, at: str) -> float:
    value = _number(text)
    if value is None or not math.isfinite(value):
        raise InputError(f"{at}: {what} = {text[:60]!r}: must be a finite number")
    return value


def _number(text: str) -> float | None:
    part = _PI_PART.fullmatch(text)
    if part is not None and int(part[1]) > 0:
        return math.pi / int(part[1])
    try:
        return float(text)
    except ValueError:
        return None
