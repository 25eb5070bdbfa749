"""What commands print: tables for people, JSON for programs."""

import json
import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from bikesim.errors import InputError

FIGURES = (".png", ".pdf", ".svg")


def print_json(value: Any) -> None:
    """One JSON document; what is not a finite number becomes null."""
    print(json.dumps(_finite(value), indent=2, allow_nan=False))


def print_table(header: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1) -> None:
    """Columns aligned: the first `left` ones to the left, the others to the right."""
    for line in table_lines(header, rows, left=left):
        print(line)


def table_lines(
    header: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1
) -> Iterator[str]:
    """The lines of `print_table`."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
    for row in [header, ["-" * width for width in widths], *rows]:
        cells = [
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield "  ".join(cells).rstrip()


def check_output(path: Path, *, force: bool) -> None:
    """Refuse a file that is there already, or a place where none can be, before the work."""
    from bikesim.record.output import output_path

    output_path(path, force=force)


def check_apart(path: Path, *others: Path) -> None:
    """Refuse to write over what the same command reads or writes."""
    if os.path.realpath(path) in map(os.path.realpath, others):
        raise InputError(f"{path}: would replace what this command needs; give another name")


def check_figure(path: Path, *, force: bool) -> None:
    """As `check_output`, for a kind of figure that can be drawn."""
    if path.suffix.lower() not in FIGURES:
        raise InputError(f"{path}: cannot draw to {path.suffix!r}; known: {', '.join(FIGURES)}")
    check_output(path, force=force)


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return value
