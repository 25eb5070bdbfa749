"""A recording of a rig, ours or another's, as a replay needs it."""

import csv
import gzip
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.record.reader import Run, open_run
from bikesim.textfile import is_special

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Recording:
    """What a replay needs of a recording; arrays with one value a tick, SI, signs as everywhere.

    `held`: that rig integrated the roll with the new sample held over the step, not with both
    interpolated. `bicycle`, `law`: of the recording, where it knows them. `run`: a record of ours.
    """

    path: Path
    time: Values
    speed: Values
    roll: Values
    roll_rate: Values
    steer: Values
    steer_rate: Values
    torque: Values
    roll_moment: Values
    steer_moment: Values
    held: bool
    bicycle: Bicycle | None = None
    law: Law | None = None
    run: Run | None = None


def read_recording(path: Path) -> Recording:
    """A record of ours, or a CSV (.csv, .csv.gz) of another rig. Raises InputError."""
    return _from_csv(path) if is_csv(path) else _from_run(open_run(path))


def is_csv(path: Path) -> bool:
    """Whether a file is, by its name, the CSV of another rig."""
    return path.name.lower().endswith((".csv", ".csv.gz"))


def _from_run(run: Run) -> Recording:
    if run.ticks == 0:
        raise InputError(f"{run.path}: no ticks are recorded in it")
    return Recording(
        path=run.path,
        time=run.time,
        speed=run.channel("speed"),
        roll=run.channel("roll"),
        roll_rate=run.channel("roll_rate"),
        steer=run.channel("steer"),
        steer_rate=run.channel("steer_rate"),
        torque=run.channel("feedback_torque"),
        roll_moment=run.channel("roll_moment"),
        steer_moment=run.channel("steer_moment"),
        held=False,
        bicycle=run.bicycle,
        law=Law(run.law),
        run=run,
    )


# What a recording has, and what a value can be; far beyond any rig's.
_CSV_COLUMNS = {
    "time_s": (-1e10, 1e10),
    "speed_m_s": (0.0, 100.0),
    "roll_rad": (-100.0, 100.0),
    "roll_rate_rad_s": (-1e4, 1e4),
    "steer_rad": (-100.0, 100.0),
    "steer_rate_rad_s": (-1e4, 1e4),
    "torque_command_Nm": (-1e4, 1e4),
}

_LONGEST_STEP = 10.0  # [s]


def _from_csv(path: Path) -> Recording:
    table = _read_csv(path)
    nothing = np.zeros_like(table["time_s"])
    return Recording(
        path=path,
        time=table["time_s"],
        speed=table["speed_m_s"],
        roll=table["roll_rad"],
        roll_rate=table["roll_rate_rad_s"],
        steer=table["steer_rad"],
        steer_rate=table["steer_rate_rad_s"],
        torque=table["torque_command_Nm"],
        roll_moment=nothing,
        steer_moment=nothing,
        held=True,
    )


def _read_csv(path: Path) -> dict[str, Values]:
    if is_special(path):
        raise InputError(f"{path}: is not a plain file, so not a recording")
    opened = gzip.open if path.suffix.lower() == ".gz" else open
    try:
        with opened(path, "rt", encoding="utf-8-sig", newline="") as file:
            return _parse_csv(path, csv.reader(file))
    except (OSError, EOFError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read: {why.lower()}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: is not a CSV text file: {error}") from None


def _parse_csv(path: Path, rows: Any) -> dict[str, Values]:
    header = next(rows, None)
    if not header:
        raise InputError(f"{path}: is empty; a recording is a CSV with a header")
    header = [name.strip() for name in header]
    if missing := [name for name in _CSV_COLUMNS if name not in header]:
        raise InputError(
            f"{path}: column {missing[0]} is missing; a recording needs {', '.join(_CSV_COLUMNS)}"
        )
    wanted = {name: header.index(name) for name in _CSV_COLUMNS}
    values: dict[str, list[float]] = {name: [] for name in wanted}
    for line, row in enumerate(rows, 2):
        for name, i in wanted.items():
            values[name].append(_cell(path, line, name, row, i))
    if not values["time_s"]:
        raise InputError(f"{path}: has a header but no rows")
    for line, (earlier, later) in enumerate(pairwise(values["time_s"]), 3):
        if later <= earlier:
            raise InputError(f"{path}: line {line}: time_s = {later} does not rise from {earlier}")
        if later - earlier > _LONGEST_STEP:
            raise InputError(
                f"{path}: line {line}: time_s = {later} is more than {_LONGEST_STEP:g} s "
                f"after {earlier}"
            )
    return {name: np.array(column) for name, column in values.items()}


def _cell(path: Path, line: int, name: str, row: list[str], i: int) -> float:
    try:
        value = float(row[i])
    except IndexError:
        raise InputError(f"{path}: line {line}: has no {name}; is the file cut short?") from None
    except ValueError:
        raise InputError(f"{path}: line {line}: {name} = {row[i]!r} is not a number") from None
    if not math.isfinite(value):
        raise InputError(f"{path}: line {line}: {name} = {row[i]} is not finite")
    least, most = _CSV_COLUMNS[name]
    if not least <= value <= most:
        raise InputError(
            f"{path}: line {line}: {name} = {row[i]}: must be from {least:g} to {most:g}"
        )
    return value
