"""Reading a small text file that a user named, with one-line errors."""

import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bikesim.errors import InputError

# Far above any such file; keeps a wrongly named recording from being read whole.
_LARGEST = 1_000_000  # bytes


@contextmanager
def located(where: str) -> Iterator[None]:
    """Puts `where` (a file's name) in front of an InputError that is raised inside."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def is_there(path: Path) -> bool:
    """Whether it is a file, also for names that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_special(path: Path) -> bool:
    """Whether it is there but neither file nor folder: a pipe or a device may never end."""
    try:
        return path.exists() and not path.is_file() and not path.is_dir()
    except OSError:
        return False


def read_text(path: Path, kind: str, largest: int = _LARGEST) -> str:
    """The text of a `kind` of file. Raises InputError for what is no text file, or above the
    `largest` size [bytes].
    """
    return _decoded(_content(path, kind, largest))


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """The keys of a `kind` of TOML file; InputError, which names kind and file, if it is none."""
    with located(f"{kind} {path}"):
        return parse_toml(read_text(path, kind))


def parse_toml(text: str) -> dict[str, Any]:
    """The keys of a TOML text. Raises InputError."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError("not TOML: nested too deeply") from None
    except ValueError as error:
        raise InputError(f"not TOML: {error}") from None


def _content(path: Path, kind: str, largest: int) -> bytes:
    try:
        if path.is_dir():
            raise InputError(f"is a folder; give a {kind} file in it")
        if is_special(path) or path.stat().st_size > largest:
            raise InputError(
                f"is not a {kind} file (a text file of less than {largest / 1e6:g} MB)"
            )
        return path.read_bytes()
    except OSError as error:
        raise InputError((error.strerror or str(error)).lower()) from None


def _decoded(content: bytes) -> str:
    try:
        # Editors on Windows put a byte order mark in front.
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("is not a text file (UTF-8)") from None
    if "\0" in text:
        raise InputError("is not a text file (UTF-8)")
    return text
