"""Files that we write: refused before anything is touched, put in place in one step."""

import contextlib
import fcntl
import os
import re
from collections.abc import Iterator
from pathlib import Path

from bikesim.errors import InputError


def output_path(path: Path, *, force: bool) -> Path:
    """The file to write, links followed, its folder made; InputError if it must not be written.

    A file that is there already is refused without `force`; anything but a plain file always.
    """
    target = Path(os.path.realpath(path))
    try:
        if file := next((p for p in target.parents if p.exists() and not p.is_dir()), None):
            raise InputError(f"{path}: cannot be written: {file.name} is not a folder")
        if target.is_dir():
            raise InputError(f"{path}: is a folder; give the name of a file")
        if target.exists() and not target.is_file():
            raise InputError(f"{path}: is not a plain file; give the name of one")
        if target.exists() and not force:
            raise InputError(f"{path}: is already there; --force replaces it")
        if target.exists() and _in_use(target):
            raise InputError(f"{path}: another run is writing it")
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from error
    return target


def part_path(path: Path) -> Path:
    """Where a file lies until it is whole: beside it, hidden, and this process's own."""
    return path.with_name(f".{path.name}.{os.getpid()}.part")


def hold(file: int) -> None:
    """Mark an open file as being written, for as long as this process has it open."""
    # A record lock, not flock: HDF5 uses that, and a run may be read while it is written.
    with contextlib.suppress(OSError):
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _in_use(path: Path) -> bool:
    with contextlib.suppress(OSError), path.open("rb+") as file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def unwritable(path: Path, error: OSError | RuntimeError, kept: str = "") -> InputError:
    """The one line for a file that the system would not write; `kept` says what is not lost."""
    code = error.errno if isinstance(error, OSError) else None
    # HDF5 tells the system's reason, if at all, deep in a text of many lines.
    told = re.search(r"error message = '([^']+)'", str(error))
    why = os.strerror(code) if code else told[1] if told else " ".join(str(error).split())
    return InputError(f"{path}: cannot be written: {why.lower()}{kept}")


@contextlib.contextmanager
def put_in_place(path: Path, *, durable: bool = True) -> Iterator[Path]:
    """Gives the name to write under; replaces `path` by it at the end, or removes it on an error.

    `durable` waits for the disk, so that a power cut cannot lose the old file and the new one.
    """
    part = part_path(path)
    try:
        yield part
        if durable:
            _sync(part)
        part.replace(path)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())
