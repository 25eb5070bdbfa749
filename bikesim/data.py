"""The files that ship with the package: MuJoCo models (`mjcf`), bench profiles (`hardware`)."""

from pathlib import Path

from bikesim.errors import InputError, unknown


def data_path(*parts: str) -> Path:
    """The path of a shipped file or folder, as in `data_path("mjcf", "rig.xml")`.

    In a wheel the folders lie inside the package, in a source tree beside it.
    Raises InputError if there is none.
    """
    path = _home().joinpath(*parts)
    if path.exists():
        return path
    if path.parent.is_dir():
        raise unknown("data file", path.name, sorted(p.name for p in path.parent.iterdir()))
    raise InputError(f"data folder {path.parent} is missing: bikesim is not installed completely")


def _home() -> Path:
    package = Path(__file__).resolve().parent
    shipped = package / "_data"
    return shipped if shipped.is_dir() else package.parent
