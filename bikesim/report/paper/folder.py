"""A folder of results that is there only when it is whole."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bikesim.errors import InputError
from bikesim.record.output import unwritable


@contextmanager
def whole_folder(path: Path, *, force: bool) -> Iterator[Path]:
    """Gives a hidden folder to fill; its files are moved into `path` at the end.

    After an error or an interruption nothing is left. A folder that is there already is refused
    without `force`; with it, files of the same names are replaced and others stay.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_dir():
        raise InputError(f"{path}: is not a folder; give the name of one")
    if target.exists() and not force:
        raise InputError(f"{path}: is already there; --force writes into it")
    part = target / ".part" if target.exists() else target.with_name(f".{target.name}.part")
    try:
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        yield part
        _move(part, target)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _move(part: Path, target: Path) -> None:
    for file in sorted(part.rglob("*")):
        if file.is_file():
            place = target / file.relative_to(part)
            place.parent.mkdir(parents=True, exist_ok=True)
            file.replace(place)
