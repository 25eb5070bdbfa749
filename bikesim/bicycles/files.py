"""Reading a small text file that a user named, with one-line errors."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bikesim.errors import InputError

# Far above any bicycle file; keeps a wrongly named recording or device from being read whole.
_LARGEST = 1_000_000  # bytes


@contextmanager
def located(where: str) -> Iterator[None]:
    """Puts `where` (a file's name) in front of an InputError that is raised inside."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def is_there(name: str) -> bool:
    """Whether `name` is that of a file or folder; False for what cannot be a path at all."""
    try:
        return bool(name) and Path(name).exists()
    except (OSError, ValueError):
        return False


def read_text(path: Path) -> str:
    """The text of a file. Raises InputError if it is missing, empty, binary, huge or a folder."""
    with located(str(path)):
        text = _decoded(_content(path))
        if not text.strip():
            raise InputError("the file is empty; a bicycle file has its parameters")
        return text


def _content(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise InputError("is a folder; give a bicycle file in it")
        if not path.exists():
            raise InputError("no such file")
        if not path.is_file() or path.stat().st_size > _LARGEST:
            raise InputError("is not a bicycle file (a text file of less than 1 MB)")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}") from error


def _decoded(content: bytes) -> str:
    try:
        # Editors on Windows put a byte order mark in front.
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("is not a text file (UTF-8)") from error
    if "\0" in text:
        raise InputError("is not a text file (UTF-8)")
    return text
