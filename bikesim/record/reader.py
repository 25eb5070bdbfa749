"""Reading a run file, whole or cut short by a kill."""

import hashlib
import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError, unknown
from bikesim.model.bicycle import Bicycle
from bikesim.record.bicycle_group import read_bicycle
from bikesim.record.channels import Channel
from bikesim.record.header import Ending
from bikesim.record.layout import FORMAT, FORMAT_VERSION
from bikesim.record.provenance import Provenance
from bikesim.textfile import is_special

if TYPE_CHECKING:
    import pandas as pd

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_DAMAGE = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError)


@dataclass(frozen=True, eq=False)
class Run:
    """A recorded run. The values of a channel are read from the file when they are asked for.

    `ticks` counts those that were written; `complete` is False, and `ending` None, for a run whose
    program was killed. `period` [s], `handlebar_inertia` [kg m²], `scenario` is TOML text.
    """

    path: Path
    channels: tuple[Channel, ...]
    timing_channels: tuple[Channel, ...]
    ticks: int
    period: float
    scenario: str
    bicycle: Bicycle
    law: str
    handlebar_inertia: float
    rig: str
    rider: str
    seed: int | None
    provenance: Provenance
    complete: bool
    ending: Ending | None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the channels."""
        return tuple(channel.name for channel in self.channels)

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each tick [s]."""
        return self.channel("time")

    @property
    def versions(self) -> tuple[tuple[str, str], ...]:
        """What made the record: each program with its version."""
        names = ("bikesim", "python", "mujoco", "numpy", "scipy", "h5py", "pydantic")
        found = ((name, getattr(self.provenance, name)) for name in names)
        return tuple((name, version) for name, version in found if version is not None)

    @property
    def commit(self) -> str | None:
        """The commit of the source tree that made the record."""
        return self.provenance.commit

    @property
    def created(self) -> str:
        """When the record was begun, ISO 8601, UTC."""
        return self.provenance.created

    def channel(self, name: str) -> NDArray[np.float64]:
        """The values of a channel, one a tick. InputError for a name that is not there."""
        return self._read("channels", name, self.channels)

    def timing(self, name: str) -> NDArray[np.float64]:
        """As `channel`, for what was measured on the clock of the machine."""
        return self._read("timing", name, self.timing_channels)

    def to_pandas(self) -> "pd.DataFrame":
        """A table with a row a tick and a column a channel; units in its `attrs`."""
        import pandas as pd

        table = pd.DataFrame({name: self.channel(name) for name in self.names})
        table.attrs["units"] = {channel.name: channel.unit for channel in self.channels}
        return table

    def digest(self) -> str:
        """SHA-256 of the names and values of all channels: equal for runs equal bit for bit."""
        digest = hashlib.sha256()
        for name in self.names:
            digest.update(name.encode() + b"\0")
            digest.update(self.channel(name).astype("<f8").tobytes())
        return digest.hexdigest()

    def _read(self, group: str, name: str, among: tuple[Channel, ...]) -> NDArray[np.float64]:
        if name not in {channel.name for channel in among}:
            known = [channel.name for channel in among]
            raise unknown(f"channel of {self.path}:", name, known)
        try:
            with h5py.File(self.path, "r", locking=False) as file:
                return np.asarray(_dataset(file, f"{group}/{name}")[: self.ticks], np.float64)
        except _DAMAGE as error:
            raise InputError(f"{self.path}: cannot be read: {_first_line(error)}") from error


def open_run(path: Path | str) -> Run:
    """The run in a file. InputError if it is missing, damaged or something else."""
    path = Path(path)
    _check_kind(path)
    try:
        with h5py.File(path, "r", locking=False) as file:
            _check_format(path, file)
            return _read_run(path, file)
    except _DAMAGE as error:
        raise InputError(f"{path}: truncated or damaged run file: {_first_line(error)}") from error


def _check_kind(path: Path) -> None:
    if path.is_dir():
        raise InputError(f"{path}: is a folder, not a run file")
    if is_special(path):
        raise InputError(f"{path}: is not a plain file, so not a run file")
    try:
        with path.open("rb") as file:
            start = file.read(len(_SIGNATURE))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {_first_line(error)}") from error
    if not start:
        raise InputError(f"{path}: is empty, not a run file")
    if start != _SIGNATURE:
        raise InputError(f"{path}: is not an HDF5 file, so not a run file")


def _check_format(path: Path, file: h5py.File) -> None:
    attributes: Any = file.attrs
    if attributes.get("format") != FORMAT:
        raise InputError(f"{path}: is an HDF5 file, but not a run of bikesim")
    version = int(attributes["format_version"])
    if version > FORMAT_VERSION:
        raise InputError(
            f"{path}: written by a newer bikesim (format {version}); "
            f"this one reads up to {FORMAT_VERSION}"
        )


def _read_run(path: Path, file: h5py.File) -> Run:
    attributes: Any = file.attrs
    complete = bool(attributes["complete"])
    return Run(
        path=path,
        channels=_read_channels(file["channels"]),
        timing_channels=_read_channels(file["timing"]),
        ticks=_count_ticks(file),
        period=float(attributes["period_s"]),
        scenario=str(attributes["scenario"]),
        bicycle=read_bicycle(_group(file, "bicycle")),
        law=str(attributes["law"]),
        handlebar_inertia=float(attributes["handlebar_inertia_kg_m2"]),
        rig=str(attributes["rig"]),
        rider=str(attributes["rider"]),
        seed=int(attributes["seed"]) if "seed" in attributes else None,
        provenance=_read_provenance(file),
        complete=complete,
        ending=_read_ending(attributes) if complete else None,
    )


def _read_channels(group: Any) -> tuple[Channel, ...]:
    return tuple(
        Channel(
            name=name,
            unit=str(dataset.attrs["unit"]),
            sign=str(dataset.attrs["sign"]),
            description=str(dataset.attrs["description"]),
        )
        for name, dataset in group.items()
    )


def _count_ticks(file: h5py.File) -> int:
    """Rows up to the first without a time: beyond it nothing was written."""
    missing = np.isnan(_dataset(file, "channels/time")[:])
    ticks = int(missing.argmax()) if missing.any() else len(missing)
    for group in ("channels", "timing"):
        for name in _group(file, group):
            if _dataset(file, f"{group}/{name}").shape != missing.shape:
                raise ValueError(f"/{group}/{name} and the time differ in length")
    return ticks


def _read_ending(attributes: Any) -> Ending:
    fall_time = float(attributes["fall_time_s"])
    return Ending(
        reason=attributes["reason"].decode(),
        fell=bool(attributes["fell"]),
        fall_time=None if math.isnan(fall_time) else fall_time,
    )


def _read_provenance(file: h5py.File) -> Provenance:
    versions: Any = _group(file, "versions").attrs
    names = [field.name for field in fields(Provenance) if field.name != "created"]
    return Provenance(
        created=str(file.attrs["created"]), **{name: versions.get(name) for name in names}
    )


def _group(file: h5py.File, name: str) -> h5py.Group:
    found = file[name]
    if not isinstance(found, h5py.Group):
        raise ValueError(f"/{name} is not a group")
    return found


def _dataset(file: h5py.File, name: str) -> h5py.Dataset:
    found = file[name]
    if not isinstance(found, h5py.Dataset):
        raise ValueError(f"/{name} is not a dataset")
    return found


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
