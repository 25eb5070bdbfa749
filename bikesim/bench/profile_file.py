"""Changing a bench profile in its file: only the entries meant, and the old one is kept."""

import json
import re
import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bikesim.bench.profile import BenchSettings, bench_names
from bikesim.errors import InputError
from bikesim.textfile import located, parse_toml, read_text


def own_profile(name: str) -> Path:
    """The path of a profile that may be changed. Raises InputError for one that ships."""
    path = Path(name)
    if path.suffix != ".toml":
        known = "ships with bikesim" if name in bench_names() else "is no file"
        raise InputError(f"bench {name}: {known}; copy a profile to a .toml file of your own first")
    read_text(path, "bench profile")
    return path


Changes = Mapping[str, float | str | list[int]]


def changed_text(text: str, changes: Changes) -> str:
    """A profile's text with others at "table.key" or "key", comments and all else as they were.

    Raises InputError where that would not be the profile meant.
    """
    lines = text.splitlines()
    for where, value in changes.items():
        table, _, key = where.rpartition(".")
        lines = _with(lines, table, key, json.dumps(value))
    changed = "\n".join(lines) + "\n"
    wanted = parse_toml(text)
    for where, value in changes.items():
        table, _, key = where.rpartition(".")
        (wanted.setdefault(table, {}) if table else wanted)[key] = value
    if parse_toml(changed) != wanted:
        raise InputError(f"cannot change {', '.join(changes)} in it; write them by hand")
    BenchSettings(**parse_toml(changed))
    return changed


def change_profile(path: Path, changes: Changes) -> Path:
    """Writes other values into a profile; gives where the old one now is. Raises InputError."""
    with located(f"bench {path}"):
        text = changed_text(read_text(path, "bench profile"), changes)
    kept = kept_beside(path)
    part = path.with_name(f".{path.name}.part")
    try:
        shutil.copy2(path, kept)
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise InputError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    return kept


def kept_beside(path: Path) -> Path:
    """A name with the date for what a file was, that there is not yet."""
    stamp = time.strftime("%Y-%m-%d-%H%M%S")
    names = (f"{path.name}.{stamp}{more}.bak" for more in ("", *(f"-{n}" for n in range(2, 100))))
    return next(one for name in names if not (one := path.with_name(name)).exists())


def _with(lines: list[str], table: str, key: str, value: str) -> list[str]:
    """Without a `table`: what is before the first."""
    begin = _line(lines, rf"\s*\[\s*{re.escape(table)}\s*\]\s*(#.*)?$", 0) if table else -1
    if begin is None:
        return [*lines, "", f"[{table}]", f"{key} = {value}"]
    after = _line(lines, r"\s*\[", begin + 1)
    end = len(lines) if after is None else after
    found = _line(lines[:end], rf"\s*{re.escape(key)}\s*=", begin + 1)
    if found is None:
        # A file begins with a comment that is about all of it.
        at = begin + 1 if table else _line(lines, r"\s*[^#\s]", 0) or 0
        return [*lines[:at], f"{key} = {value}", *lines[at:]]
    said: Any = re.match(r"(\s*[\w-]+\s*=\s*)[^#]*?(\s*#.*)?$", lines[found])
    line = f"{said[1]}{value}{said[2] or ''}"
    return [*lines[:found], line, *lines[found + 1 :]]


def _line(lines: list[str], pattern: str, begin: int) -> int | None:
    return next((i for i in range(begin, len(lines)) if re.match(pattern, lines[i])), None)
