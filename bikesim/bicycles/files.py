"""Files and names of bicycles that a user gave."""

from pathlib import Path

from bikesim import textfile
from bikesim.errors import InputError
from bikesim.textfile import located


def is_there(name: str) -> bool:
    """Whether `name` is that of a file or folder; False for what cannot be a path at all."""
    try:
        return bool(name) and Path(name).exists()
    except (OSError, ValueError):
        return False


def read_text(path: Path) -> str:
    """The text of a file. Raises InputError if it is missing, empty, binary, huge or a folder."""
    with located(str(path)):
        text = textfile.read_text(path, "bicycle")
        if not text.strip():
            raise InputError("the file is empty; a bicycle file has its parameters")
        return text
