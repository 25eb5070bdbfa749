"""The run file in HDF5: what lies where.

    /channels/<name>   float64, one a tick; attributes unit, sign, description; reproducible
    /timing/<name>     the same, measured on the clock of this machine
    /bicycle           M, C1, K0, K2; attributes name, source, wheelbase, trail, ...
    /versions          attributes: what made the record
    /                  attributes: the header, and from `ENDING` on what is known at the end

All of it is laid out, with room for every tick, before the first tick: HDF5 never has to change
the structure of a file that is being written, which is what a kill could leave half done.
"""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from bikesim.record.bicycle_group import write_bicycle
from bikesim.record.channels import TIMING_CHANNELS, Channel
from bikesim.record.header import Ending, RunHeader

FORMAT = "bikesim run"
FORMAT_VERSION = 1
REASON_BYTES = 200
STRUCTURE_BYTES = 256 * 1024  # more than the file takes beside the ticks and the scenario

# The attributes of the end, as they are until then. Each keeps its type and its place.
ENDING: dict[str, Any] = {
    "complete": np.bool_(False),
    "reason": b"",
    "fell": np.bool_(False),
    "fall_time_s": math.nan,
    "ticks": np.int64(-1),
    "compute_time_median_s": math.nan,
    "compute_time_p99_s": math.nan,
    "compute_time_max_s": math.nan,
}


@dataclass(frozen=True)
class Layout:
    """A run file's columns in the order of a row, and what stands beside them."""

    channels: tuple[Channel, ...]
    period: float
    header: RunHeader

    def __post_init__(self) -> None:
        if len(set(self.columns)) < len(self.columns) or "channels/time" not in self.columns:
            raise ValueError(f"channels {self.columns}: each once, with the time among them")
        if not 0 < self.period < math.inf:
            raise ValueError(f"period = {self.period} s: must be above 0")

    @property
    def columns(self) -> tuple[str, ...]:
        """The datasets, in the order of a row: the channels, then the timing."""
        return tuple(f"channels/{channel.name}" for channel in self.channels) + tuple(
            f"timing/{channel.name}" for channel in TIMING_CHANNELS
        )

    def create(self, path: Path, capacity: int) -> tuple[int, ...]:
        """A new file at `path` with room for `capacity` ticks; where each column begins [byte].

        Raises OSError.
        """
        _probe(path, 8 * capacity * len(self.columns) + STRUCTURE_BYTES)
        with h5py.File(path, "w", locking=False) as file:
            self._write_root(file)
            write_bicycle(file.create_group("bicycle"), self.header.bicycle)
            _write_channels(file, "channels", self.channels, capacity)
            _write_channels(file, "timing", TIMING_CHANNELS, capacity)
            return tuple(_place(file[column]) for column in self.columns)

    def _write_root(self, file: h5py.File) -> None:
        header, provenance = self.header, self.header.provenance
        file.attrs["format"] = FORMAT
        file.attrs["format_version"] = FORMAT_VERSION
        for name in ("scenario", "law", "rig", "rider"):
            file.attrs[name] = getattr(header, name)
        file.attrs["handlebar_inertia_kg_m2"] = header.handlebar_inertia
        file.attrs["period_s"] = self.period
        if header.seed is not None:
            file.attrs["seed"] = np.int64(header.seed)
        file.attrs["created"] = provenance.created
        for name, value in ENDING.items():
            dtype = f"S{REASON_BYTES}" if name == "reason" else None
            file.attrs.create(name, value, dtype=dtype)
        versions = file.create_group("versions")
        for name, value in asdict(provenance).items():
            if value is not None and name != "created":
                versions.attrs[name] = value


def write_ending(file: h5py.File, ending: Ending, compute_time: np.ndarray) -> None:
    """The attributes of the end, in place: no byte of the file moves."""
    values = {
        "reason": _one_line(ending.reason),
        "fell": np.bool_(ending.fell),
        "fall_time_s": math.nan if ending.fall_time is None else ending.fall_time,
        "ticks": np.int64(len(compute_time)),
    }
    if len(compute_time):
        median, p99, largest = np.percentile(compute_time, (50, 99, 100))
        values["compute_time_median_s"] = median
        values["compute_time_p99_s"] = p99
        values["compute_time_max_s"] = largest
    for name, value in values.items():
        file.attrs.modify(name, value)
    file.attrs.modify("complete", np.bool_(True))


def _write_channels(
    file: h5py.File, group_name: str, channels: tuple[Channel, ...], capacity: int
) -> None:
    group = file.create_group(group_name, track_order=True)
    for channel in channels:
        dataset = _reserve(group, channel.name, capacity)
        for name in ("unit", "sign", "description"):
            dataset.attrs[name] = getattr(channel, name)


def _reserve(group: h5py.Group, name: str, capacity: int) -> h5py.Dataset:
    """A dataset in one piece whose place in the file is fixed now, not at the first write."""
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_layout(h5py.h5d.CONTIGUOUS)
    properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    properties.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    properties.set_fill_value(np.array(math.nan))
    space = h5py.h5s.create_simple((capacity,))
    low = h5py.h5d.create(group.id, name.encode(), h5py.h5t.IEEE_F64LE, space, properties)
    return h5py.Dataset(low)


def _place(dataset: Any) -> int:
    return dataset.id.get_offset() or 0  # None where there is no tick to place


def _probe(path: Path, size: int) -> None:
    """Meet the limits of the disk here: HDF5 that meets them cannot close its file any more."""
    with path.open("wb") as file:
        file.write(bytes(STRUCTURE_BYTES))
        file.flush()
        file.truncate(size)


def _one_line(text: str) -> bytes:
    line = " ".join(text.split()).encode()[:REASON_BYTES]
    return line.decode(errors="ignore").encode()
