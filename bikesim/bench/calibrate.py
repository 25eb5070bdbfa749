"""Zero and scales of a bench's steer sensors, from positions that a person holds and swings.

Pure: samples in, calibration out. The positions give zero and scale of the angle, and the gyro's
zero; the gyro's scale follows from swings, in which its integral must be the angle.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.bench.calibration import NodeCalibration
from bikesim.errors import InputError

Reals = NDArray[np.float64]

LEAST_SPAN = math.radians(20.0)
"""From the first position to the last, and of a swing [rad]."""

_STILL = math.radians(0.5)  # most that a held bar moves, rms
_OFF_LINE = math.radians(1.0)  # most that a position is off the line through all
_RESTING_RATE = 0.02  # rad/s, spread of the gyro over the positions
_SWING_MISFIT = 0.03  # of the swing's rms angle
_FACTOR = 2.0  # a scale further off than this is no calibration
_ENCODER_WITHIN = 0.03


class Held(NamedTuple):
    """A position: `angle` [rad] as the person reads it, and what the sensors said meanwhile, (n,).

    `pot` and `gyro` are raw, 0 to 1.
    """

    angle: float
    pot: Reals
    gyro: Reals


class Swings(NamedTuple):
    """Swings to and fro: the node's `time` (n,) [s], raw `pot` and `gyro` (n,)."""

    time: Reals
    pot: Reals
    gyro: Reals


class Calibrated(NamedTuple):
    """A calibration, and how well it fits.

    `off_line` [rad], the most that a position is off; `swing_misfit`, what is left of the swings'
    angle, rms over rms.
    """

    calibration: NodeCalibration
    off_line: float
    swing_misfit: float


def calibrated(
    held: Sequence[Held], swings: Swings, acting: NodeCalibration, *, anew: bool = False
) -> Calibrated:
    """The calibration that positions and swings show. Raises InputError where they do not fit.

    `acting` is the one in the node, from which no scale may be further off than a factor of two,
    nor have the other sign; `anew`: these are other sensors, it may.
    """
    angles = np.array([one.angle for one in held])
    if len(held) < 2 or np.ptp(angles) < LEAST_SPAN:
        raise InputError(
            f"positions from {math.degrees(angles.min()):g} to {math.degrees(angles.max()):g} deg: "
            f"at least two, {math.degrees(LEAST_SPAN):g} deg apart"
        )
    zero, scale, off_line = _angle(held)
    gyro_zero = float(np.mean([one.gyro.mean() for one in held]))
    rate_scale, misfit = _rate(swings, scale, gyro_zero)
    resting = np.ptp([one.gyro.mean() for one in held]) * abs(rate_scale)
    if resting > _RESTING_RATE:
        raise InputError(
            f"the gyro at rest differs by {resting:.3f} rad/s between the positions: allowed "
            f"{_RESTING_RATE:g}; hold the bar still"
        )
    if not anew:
        _same_sensors("angle", scale, acting.angle_scale)
        _same_sensors("gyro", rate_scale, acting.rate_scale)
    found = acting._replace(
        pot_zero=zero, angle_scale=scale, gyro_zero=gyro_zero, rate_scale=rate_scale
    )
    return Calibrated(found, off_line, misfit)


def _angle(held: Sequence[Held]) -> tuple[float, float, float]:
    """Zero and scale of the potentiometer, and the most that a position is off the line [rad]."""
    angles = np.array([one.angle for one in held])
    pots = np.array([one.pot.mean() for one in held])
    slope, zero = np.polyfit(angles, pots, 1)
    if abs(slope) < 1e-3:
        raise InputError("the potentiometer does not follow the bar: is it connected?")
    scale = 1.0 / float(slope)
    for one in held:
        moved = float(np.std(one.pot)) * abs(scale)
        if moved > _STILL:
            raise InputError(
                f"the bar moved by {math.degrees(moved):.1f} deg while it was to be held at "
                f"{math.degrees(one.angle):g} deg; allowed {math.degrees(_STILL):g}"
            )
    off = (pots - zero) * scale - angles
    worst = int(np.argmax(np.abs(off)))
    if abs(off[worst]) > _OFF_LINE:
        raise InputError(
            f"the position {math.degrees(angles[worst]):g} deg is {math.degrees(off[worst]):+.1f} "
            f"deg off the line through all: allowed {math.degrees(_OFF_LINE):g}; was it read right?"
        )
    if not 0.02 < zero < 0.98:
        raise InputError(
            f"straight ahead the potentiometer is at {100 * zero:.0f} % of its range: turn it on "
            "its shaft, so that it is near the middle"
        )
    return float(zero), scale, float(np.abs(off).max())


def _rate(swings: Swings, angle_scale: float, gyro_zero: float) -> tuple[float, float]:
    """Scale of the gyro, and the part of the swings' angle that its integral leaves."""
    angle = angle_scale * swings.pot
    if len(angle) < 100 or np.ptp(angle) < LEAST_SPAN:
        raise InputError(
            f"the swings are {math.degrees(float(np.ptp(angle))) if len(angle) else 0:.0f} deg "
            f"wide: at least {math.degrees(LEAST_SPAN):g}"
        )
    steps = np.diff(swings.time)
    raw = swings.gyro - gyro_zero
    turned = np.append(0.0, np.cumsum(0.5 * (raw[1:] + raw[:-1]) * steps))
    # A constant for where they begin; a line for a zero that drifted since the positions.
    columns = np.column_stack([turned, np.ones_like(turned), swings.time - swings.time[0]])
    solved, *_ = np.linalg.lstsq(columns, angle, rcond=None)
    left = angle - columns @ solved
    misfit = float(np.sqrt(np.mean(left**2)) / np.std(angle))
    if misfit > _SWING_MISFIT:
        raise InputError(
            f"the gyro's integral is {100 * misfit:.0f} % off the angle over the swings: allowed "
            f"{100 * _SWING_MISFIT:g} %; is the gyro's axis the steer axis?"
        )
    return float(solved[0]), misfit


def _same_sensors(what: str, new: float, old: float) -> None:
    ratio = new / old
    if not 1 / _FACTOR <= ratio <= _FACTOR:
        raise InputError(
            f"the {what} scale would be {ratio:.2f} of the one in the node: {1 / _FACTOR:g} to "
            f"{_FACTOR:g} is a calibration; were positions and signs right (right is positive)? "
            "--anew for other sensors"
        )


def encoder_zero(held: Sequence[tuple[float, float]]) -> float:
    """`bar.drive_zero` [rad] of a bench whose steer is the drive's encoder.

    From pairs of the angle that the person reads and what the encoder says [rad]. Its scale is the
    profile's gear and counts; raises InputError where they are wrong.
    """
    told, said = np.array(held, float).T
    if len(held) < 2 or np.ptp(told) < LEAST_SPAN:
        raise InputError(f"at least two positions, {math.degrees(LEAST_SPAN):g} deg apart")
    scale, _ = np.polyfit(told, said, 1)
    if abs(scale - 1.0) > _ENCODER_WITHIN:
        raise InputError(
            f"the drive's encoder turns {scale:.3f} times as far as the bar: allowed 1 ± "
            f"{_ENCODER_WITHIN:g}; drive.gear, encoder_counts or direction is wrong"
        )
    off = said - told
    zero = float(off.mean())
    if (most := float(np.abs(off - zero).max())) > _OFF_LINE:
        raise InputError(
            f"the positions are up to {math.degrees(most):.1f} deg off the encoder: allowed "
            f"{math.degrees(_OFF_LINE):g}"
        )
    return zero
