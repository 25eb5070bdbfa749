"""A path from a text file of points, and as a smooth curve through them."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path as FilePath
from statistics import median

from bikesim.errors import InputError
from bikesim.textfile import located, read_text

FEWEST, MOST = 4, 5000  # points
_FAR, _TIMES = 5.0, 10.0  # a jump: farther apart than this [m], and than so many times the usual
_BACK = math.radians(135)

Point = tuple[float, float]


def read_points(file: FilePath) -> tuple[Point, ...]:
    """The columns x and y [m] of a text file, separated by semicolon, comma, tab or blanks.

    Its first line may name the columns; without names x is the first and y the second. Empty
    lines and those that begin with # are left out. Raises InputError.
    """
    with located(f"path.file {file}"):
        lines = [
            (number, _words(line))
            for number, line in enumerate(read_text(file, "path").splitlines(), start=1)
            if line.strip() and not line.lstrip().startswith("#")
        ]
        columns = (0, 1)
        if lines and not any(_is_number(word) for word in lines[0][1]):
            names = [word.strip("\"'").lower() for word in lines.pop(0)[1]]
            columns = (_column(names, "x", 0), _column(names, "y", 1))
        return tuple(_point(number, words, columns) for number, words in lines)


def _words(line: str) -> list[str]:
    separator = next((one for one in ";,\t" if one in line), None)
    return [word.strip() for word in line.split(separator)]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _column(names: Sequence[str], name: str, otherwise: int) -> int:
    """Where the column is that is named x, x_m, x[m] or the like."""
    found = (i for i, text in enumerate(names) if re.match(rf"{name}(\W|_|$)", text))
    return next(found, otherwise)


def _point(number: int, words: Sequence[str], columns: tuple[int, int]) -> Point:
    if len(words) <= max(columns):
        raise InputError(f"line {number}: {len(words)} columns, x and y [m] are needed")
    x, y = (words[column] for column in columns)
    for word in (x, y):
        if not _is_number(word) or not math.isfinite(float(word)):
            raise InputError(f"line {number}: {word[:40]!r} must be a number")
    return float(x), float(y)


def check_points(points: Sequence[Point]) -> None:
    """Raises InputError for points that are no path: too few, far apart, or turning back."""
    if not FEWEST <= len(points) <= MOST:
        raise InputError(
            f"path: {len(points)} different points: must be at least {FEWEST} and at most {MOST}"
        )
    gaps = [math.dist(a, b) for a, b in pairwise(points)]
    usual = median(gaps)
    widest = max(range(len(gaps)), key=gaps.__getitem__)
    if gaps[widest] > max(_FAR, _TIMES * usual):
        raise InputError(
            f"path: jumps by {gaps[widest]:.3g} m from point {widest + 1} to the next, where "
            f"points lie {usual:.2g} m apart: must be at most {max(_FAR, _TIMES * usual):.2g} m"
        )
    ways = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    for i, (a, b) in enumerate(pairwise(ways)):
        turn = abs(math.remainder(b - a, math.tau))
        if turn > _BACK:
            raise InputError(
                f"path: turns back at point {i + 2}, by {math.degrees(turn):.0f} deg: must be at "
                f"most {math.degrees(_BACK):.0f} deg from point to point"
            )
