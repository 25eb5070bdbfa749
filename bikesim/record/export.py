"""A run in the formats of other programs: CSV, Parquet, MATLAB."""

import re
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bikesim.errors import InputError
from bikesim.record.channels import Channel
from bikesim.record.output import output_path, put_in_place, unwritable
from bikesim.record.reader import Run

_ROWS = 10_000  # of text made at once


def export_run(run: Run, path: Path, force: bool = False) -> Path:
    """Write a run as the suffix of `path` says: .csv, .parquet or .mat; returns the path written.

    The timing channels follow the others. Raises InputError for an unknown suffix, for a file that
    is there already (unless `force`) or cannot be written.
    """
    write = _writer(path)
    target = output_path(path, force=force)
    try:
        with put_in_place(target) as part:
            write(run, part)
    except OSError as error:
        raise unwritable(path, error) from error
    return target


def column_name(channel: Channel) -> str:
    """A channel's name with its unit, as in `roll_rate_rad_s` or `sent_torque_N_m`."""
    unit = re.sub(r"[^0-9A-Za-z]+", "_", channel.unit.replace("²", "2")).strip("_")
    return channel.name if unit in ("", "1") else f"{channel.name}_{unit}"


def _writer(path: Path) -> Callable[[Run, Path], None]:
    match path.suffix.lower():
        case ".csv":
            return _write_csv
        case ".parquet":
            return _write_parquet
        case ".mat":
            return _write_mat
    raise InputError(f"{path}: cannot export to {path.suffix!r}; known: .csv, .parquet, .mat")


def _columns(run: Run) -> list[tuple[Channel, np.ndarray]]:
    return [(channel, run.channel(channel.name)) for channel in run.channels] + [
        (channel, run.timing(channel.name)) for channel in run.timing_channels
    ]


def _write_csv(run: Run, path: Path) -> None:
    columns = _columns(run)
    table = np.column_stack([values for _, values in columns])
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(column_name(channel) for channel, _ in columns) + "\n")
        for first in range(0, len(table), _ROWS):
            # repr gives the shortest text that reads back as the same float64.
            rows = table[first : first + _ROWS].tolist()
            file.writelines(",".join(map(repr, row)) + "\n" for row in rows)


def _write_parquet(run: Run, path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = _columns(run)
    fields = [
        pa.field(
            channel.name,
            pa.float64(),
            metadata={
                "unit": channel.unit,
                "sign": channel.sign,
                "description": channel.description,
            },
        )
        for channel, _ in columns
    ]
    schema = pa.schema(fields, metadata=_about(run))
    with path.open("wb") as file:
        pq.write_table(pa.table([values for _, values in columns], schema=schema), file)


def _write_mat(run: Run, path: Path) -> None:
    from scipy.io import savemat

    columns = _columns(run)
    variables = {
        "data": {channel.name: values for channel, values in columns},
        "unit": {channel.name: channel.unit for channel, _ in columns},
        "sign": {channel.name: channel.sign for channel, _ in columns},
        "description": {channel.name: channel.description for channel, _ in columns},
        "bicycle": {name: getattr(run.bicycle.matrices, name) for name in ("M", "C1", "K0", "K2")},
        "about": _about(run),
    }
    savemat(str(path), variables, appendmat=False, oned_as="column", long_field_names=True)


def _about(run: Run) -> dict[str, str]:
    """What the run was, as text."""
    about = {
        "scenario": run.scenario,
        "bicycle": run.bicycle.name,
        "law": run.law,
        "rig": run.rig,
        "rider": run.rider,
        "seed": "" if run.seed is None else str(run.seed),
        "ending": "not closed" if run.ending is None else run.ending.reason,
    }
    versions = asdict(run.provenance)
    return about | {name: value for name, value in versions.items() if value is not None}
