"""Our law held against a recording, tick by tick."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.record.recording import Recording, Values

# Beyond this roll a bicycle has fallen, and a rig may do anything [rad].
_FALLEN = math.pi / 4


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
    # Ours integrates over the times that it measured, that rig over its nominal period.
    began, ended = (0.0, _period(r)) if r.held else (r.time[now], r.time[then])
    before = haptic.start(
        time=began,
        steer=r.steer[begin],
        steer_rate=r.steer_rate[begin],
        speed=r.speed[begin],
        roll=r.roll[now],
        roll_rate=r.roll_rate[now],
        roll_moment=r.roll_moment[begin],
        steer_moment=r.steer_moment[begin],
    )
    after = haptic.step(
        before, ended, r.steer[then], r.steer_rate[then], r.speed[then],
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
