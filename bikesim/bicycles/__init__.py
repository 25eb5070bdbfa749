"""Bicycles by name or by file: `load`, `names`, `to_toml`.

numpy is imported by the first `load`, not by this package, so that help stays quick.
"""

from os import PathLike
from typing import TYPE_CHECKING

from bikesim.bicycles.shipped import names

if TYPE_CHECKING:
    from bikesim.model.bicycle import Bicycle

__all__ = ["load", "names", "to_toml"]


def load(name_or_path: "str | PathLike[str]") -> "Bicycle":
    """The bicycle of a shipped name, of a file, or of "frame+rider".

    A file is our TOML (`.toml`) or `key = value` lines; it is taken as written. In "frame+rider"
    the frame is a name or a file, the rider a file with the rider's part of the rear frame.
    Raises InputError, with the file and the key, where that gives no bicycle.
    """
    from bikesim.bicycles.loading import load_bicycle

    return load_bicycle(name_or_path)


def to_toml(bicycle: "Bicycle") -> str:
    """The bicycle as the text of a TOML file that `load` reads back to the same figures."""
    from bikesim.bicycles.toml_writer import bicycle_to_toml

    return bicycle_to_toml(bicycle)
