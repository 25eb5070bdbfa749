"""The EDS of a CiA 402 drive: read, and held against what is to be written by it."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from bikesim.bench.cia402_objects import Write
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.data import data_path
from bikesim.errors import InputError

if TYPE_CHECKING:
    from canopen import ObjectDictionary
    from canopen.objectdictionary import ODVariable


def read_eds(drive: Cia402Settings) -> "ObjectDictionary":
    """The objects that the EDS of a drive has.

    Makers' files are UTF-8 or, with a µ or a ®, Latin-1. Raises InputError for what is no EDS.
    """
    import canopen

    path = _path(drive.eds)
    try:
        with path.open(encoding=_encoding(path)) as file:
            return canopen.import_od(file, drive.node)
    except Exception as error:  # a bad file ends canopen's reader in whatever it comes upon
        why = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(f"drive.eds = {drive.eds!r}: cannot be read as an EDS: {why}") from None


def check_fits(
    dictionary: "ObjectDictionary", writes: Iterable[Write], drive: Cia402Settings
) -> None:
    """Raises InputError for a value that its object cannot have, as the EDS types it."""
    for write in writes:
        found = dictionary.get_variable(write.index, write.subindex)
        # Without subindices, an object is found under any.
        if found is None or found.subindex != write.subindex:
            continue
        if (allowed := _range(found)) is None:
            raise InputError(
                f"drive {drive.node}: {write.name} is no whole number in {drive.eds}, "
                "and only such objects can be written"
            )
        if write.value not in allowed:
            raise InputError(
                f"drive {drive.node}: {write.name} = {write.value} does not fit its type in "
                f"{drive.eds}: {allowed[0]} to {allowed[-1]} are allowed"
            )


def _path(eds: str) -> Path:
    path = Path(eds)
    if path.name == eds and not path.exists():
        path = data_path("hardware", "can", eds)
    if not path.is_file():
        raise InputError(f"drive.eds = {eds!r}: there is no such file")
    return path


def _encoding(path: Path) -> str:
    try:
        path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _range(variable: "ODVariable") -> range | None:
    """Of what a whole number of its type can be; None if it is another type."""
    from canopen.objectdictionary import datatypes

    if variable.data_type == datatypes.BOOLEAN:
        return range(2)
    if variable.data_type in datatypes.SIGNED_TYPES:
        half = 1 << len(variable) - 1
        return range(-half, half)
    if variable.data_type in datatypes.UNSIGNED_TYPES:
        return range(1 << len(variable))
    return None
