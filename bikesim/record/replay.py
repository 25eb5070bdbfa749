"""Our law held against a recording, tick by tick."""

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
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.record.reader import Run, open_run

Values = NDArray[np.float64]

# Beyond this roll a bicycle has fallen, and a rig may do anything [rad].
_FALLEN = math.pi / 4


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


@dataclass(frozen=True)
class Comparison:
    """Largest errors of our law over the ticks until the fall, SI."""

    law: str
    rows: int
    compared_rows: int
    max_torque_error: float
    rms_torque_error: float
    max_one_step_roll_error: float
    max_one_step_roll_rate_error: float

    def as_json(self) -> dict[str, Any]:
        """The keys of `bikesim replay --json`."""
        return {
            "rows": self.rows,
            "compared_rows": self.compared_rows,
            "max_torque_error_N_m": self.max_torque_error,
            "rms_torque_error_N_m": self.rms_torque_error,
            "max_one_step_roll_error_rad": self.max_one_step_roll_error,
            "max_one_step_roll_rate_error_rad_s": self.max_one_step_roll_rate_error,
        }


def compare(
    recording: Recording,
    bicycle: Bicycle,
    *,
    law: str | None = None,
    torque_limit: float | None = None,
) -> Comparison:
    """Eq. 6 on the recorded states, and eq. 4 over single steps from them, against the recording.

    Each step starts again at the recorded roll: open loop the roll of a bicycle diverges. All
    ticks are one call of the law on arrays. `torque_limit` [N m] clips ours as theirs was.
    """
    haptic = HapticBicycle(bicycle, _law(law, recording))
    until = _until_fall(recording.roll)
    if until < 2:
        raise InputError(f"{recording.path}: rows before the fall: {until}; at least 2 are needed")
    r = recording
    states = haptic.start(
        steer=r.steer[:until],
        steer_rate=r.steer_rate[:until],
        speed=r.speed[:until],
        roll=r.roll[:until],
        roll_rate=r.roll_rate[:until],
        roll_moment=r.roll_moment[:until],
        steer_moment=r.steer_moment[:until],
    )
    ours = states.feedback_torque
    if torque_limit is not None:
        ours = np.clip(ours, -torque_limit, torque_limit)
    torque_error = np.abs(ours - r.torque[:until])
    roll_error, roll_rate_error = _one_step_errors(recording, haptic, until)
    return Comparison(
        law=haptic.law,
        rows=len(r.time),
        compared_rows=until,
        max_torque_error=float(torque_error.max()),
        rms_torque_error=float(np.sqrt(np.mean(torque_error**2))),
        max_one_step_roll_error=roll_error,
        max_one_step_roll_rate_error=roll_rate_error,
    )


def _one_step_errors(r: Recording, haptic: HapticBicycle, until: int) -> tuple[float, float]:
    now, then = slice(0, until - 1), slice(1, until)
    # A rig that holds the new sample has, in effect, had it from the beginning of the step.
    begin = then if r.held else now
    before = haptic.start(
        steer=r.steer[begin],
        steer_rate=r.steer_rate[begin],
        speed=r.speed[begin],
        roll=r.roll[now],
        roll_rate=r.roll_rate[now],
        roll_moment=r.roll_moment[begin],
        steer_moment=r.steer_moment[begin],
    )
    after = haptic.step(
        before, _period(r), r.steer[then], r.steer_rate[then], r.speed[then],
        r.roll_moment[then], r.steer_moment[then],
    )  # fmt: skip
    return (
        float(np.abs(after.roll - r.roll[then]).max()),
        float(np.abs(after.roll_rate - r.roll_rate[then]).max()),
    )


def _period(r: Recording) -> float:
    """The period that the recording's rig integrated with [s]: the usual one, jitter left out."""
    return round(float(np.median(np.diff(r.time))), 9)


def _law(name: str | None, recording: Recording) -> Law:
    if name is None:
        return recording.law or Law.PAPER
    try:
        return Law(name)
    except ValueError:
        raise InputError(f"--law {name}: must be one of {', '.join(Law)}") from None


def _until_fall(roll: Values) -> int:
    fallen = np.abs(roll) > _FALLEN
    return int(fallen.argmax()) if fallen.any() else len(roll)


def read_recording(path: Path) -> Recording:
    """A record of ours, or a CSV (.csv, .csv.gz) of another rig. Raises InputError."""
    name = path.name.lower()
    if name.endswith((".csv", ".csv.gz")):
        return _from_csv(path)
    return _from_run(open_run(path))


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


_CSV_COLUMNS = (
    "time_s", "speed_m_s", "roll_rad", "roll_rate_rad_s", "steer_rad", "steer_rate_rad_s",
    "torque_command_Nm",
)  # fmt: skip


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
    opened = gzip.open if path.suffix.lower() == ".gz" else open
    try:
        with opened(path, "rt", encoding="utf-8", newline="") as file:
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
    return value
