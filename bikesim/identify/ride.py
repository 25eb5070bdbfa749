"""What identification needs of a record: what the rider saw and felt, and what he did."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law

Values = NDArray[np.floating[Any]]

STATIONARY = 0.02
"""Largest change of speed over a run, of its mean, that is taken for none."""


@dataclass(frozen=True, eq=False)
class Passive:
    """What holds the bar beside the torque of `rider_torque`: kg m², N m s/rad, N m/rad."""

    inertia: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True, eq=False)
class Ride:
    """A record from its first tick until the fall; arrays (m,), SI, signs as in the record.

    `speed` [m/s] is the mean, `inertia` I_δ [kg m²] that of the rig without arms. `motor_torque`
    is what acted on the bar, or was sent; `rider_torque` is None where no channel has it, `heading`
    and `y` where the record has none. `passive` is what the record says of the rider's arms. `fell`
    [s] is None for a rider who stayed up.
    """

    name: str
    bicycle: Bicycle
    law: Law
    inertia: float
    rider: str | None
    speed: float
    speed_range: float
    fell: float | None
    period: float
    roll: Values
    roll_rate: Values
    steer: Values
    steer_rate: Values
    motor_torque: Values
    roll_moment: Values
    steer_moment: Values
    rider_torque: Values | None = None
    heading: Values | None = None
    y: Values | None = None
    passive: Passive = Passive()
    straight: bool = True

    def __post_init__(self) -> None:
        for name in _SIGNALS:
            values = getattr(self, name)
            if values is not None and not np.isfinite(values).all():
                first = int(np.argmin(np.isfinite(values)))
                raise InputError(
                    f"{self.name}: {name} is {values[first]} at {first * self.period:.6g} s: "
                    "it must be a number at every tick"
                )

    @property
    def duration(self) -> float:
        """[s]"""
        return len(self.roll) * self.period

    @property
    def disturbed(self) -> bool:
        """Whether something known pushed the bicycle."""
        return bool(self.roll_moment.any() or self.steer_moment.any())


_SIGNALS = (
    "roll", "roll_rate", "steer", "steer_rate", "motor_torque", "roll_moment", "steer_moment",
    "rider_torque", "heading", "y",
)  # fmt: skip


def read_ride(
    path: Path,
    *,
    bicycle: Bicycle | None = None,
    inertia: float | None = None,
    gravity: float | None = None,
    law: Law | None = None,
) -> Ride:
    """A record of ours, or the CSV of another rig (`bikesim replay --help` says which columns).

    `bicycle`, `inertia` I_δ [kg m²], `gravity` [m/s²] and `law` replace those of the record; a CSV
    has none, so it needs a bicycle and an inertia. Raises InputError.
    """
    from bikesim.identify.reading import of_recording, of_run
    from bikesim.record.reader import open_run
    from bikesim.record.recording import is_csv

    if is_csv(path):
        ride = of_recording(path, bicycle, inertia, law or Law.PAPER)
    else:
        ride = of_run(open_run(path), bicycle, inertia, law)
    return ride if gravity is None else _replaced(ride, bicycle=ride.bicycle.with_gravity(gravity))


def check_together(rides: Sequence[Ride]) -> None:
    """Refuse rides that no one set of gains can be asked of, or one twice. Raises InputError."""
    first = rides[0]
    for ride in rides[1:]:
        for what, one, other in _compared(first, ride):
            if one != other:
                raise InputError(
                    f"{ride.name}: {what} {other}, but {first.name} has {one}: identify them apart"
                )
        if not math.isclose(ride.speed, first.speed, rel_tol=STATIONARY):
            raise InputError(
                f"{ride.name}: ridden at {ride.speed:.4g} m/s, but {first.name} at "
                f"{first.speed:.4g} m/s: identify them apart"
            )
    for one, other in combinations(rides, 2):
        if _same(one, other):
            raise InputError(
                f"{other.name}: the same ride as {one.name}, by its signals; it counts once"
            )


def _same(one: Ride, other: Ride) -> bool:
    """Whether one has the other's signals, or the shorter those at the longer's beginning.

    Counted as two they would make intervals too narrow, under whatever names and in whatever files.
    """
    n = min(len(one.roll), len(other.roll))
    return all(
        np.array_equal(mine[:n], yours[:n])
        for mine, yours in ((one.roll, other.roll), (one.steer, other.steer))
    )


def _compared(one: Ride, other: Ride) -> list[tuple[str, Any, Any]]:
    same_matrices = all(
        np.array_equal(getattr(one.bicycle.matrices, name), getattr(other.bicycle.matrices, name))
        for name in ("M", "C1", "K0", "K2")
    )
    pairs = [
        ("bicycle", one.bicycle.name, other.bicycle.name),
        ("law", one.law.value, other.law.value),
        ("rider", one.rider, other.rider),
        ("loop period", f"{one.period:g} s", f"{other.period:g} s"),
        ("known disturbance:", _yes(one.disturbed), _yes(other.disturbed)),
        ("rider_torque channel:", *(_yes(r.rider_torque is not None) for r in (one, other))),
        ("gravity", one.bicycle.gravity, other.bicycle.gravity),
    ]
    if not same_matrices:
        pairs.append(("bicycle's matrices", "others", "their own"))
    return pairs


def _yes(there: bool) -> str:
    return "yes" if there else "no"


def _replaced(ride: Ride, **changes: Any) -> Ride:
    from dataclasses import replace

    return replace(ride, **changes)
