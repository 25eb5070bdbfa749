"""Where the bicycle of a record is at any time."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.record.reader import Run

Values = NDArray[np.float64]


class Pose(NamedTuple):
    """A bicycle at one time, SI, signs of the record: roll > 0 to the right, y to the right."""

    time: float
    speed: float
    roll: float
    steer: float
    heading: float
    x: float
    y: float
    distance: float


class PoseTrack:
    """The poses of a record, linear between ticks; `first` and `last` [s] are its ends.

    Ticks from the first on that is not finite are left out. Raises InputError for a record without
    the channels of a pose, or without a tick.
    """

    def __init__(self, run: "Run") -> None:
        channels = [needed(run, name) for name in Pose._fields]
        self.ticks = _finite_ticks(channels)
        if self.ticks == 0:
            raise InputError(f"{run.path}: no ticks are recorded in it, nothing to draw")
        self._channels = [values[: self.ticks] for values in channels]
        heading = Pose._fields.index("heading")
        self._channels[heading] = np.unwrap(self._channels[heading])
        self.time = self._channels[0]
        self.first, self.last = float(self.time[0]), float(self.time[-1])

    def at(self, time: float) -> Pose:
        """The pose at a time [s]; before the first and after the last tick, that tick's."""
        return Pose(*(float(np.interp(time, self.time, values)) for values in self._channels))

    def sampled(self, times: Values) -> Values:
        """The poses at many times, a row each."""
        return np.stack([np.interp(times, self.time, values) for values in self._channels], axis=1)


def needed(run: "Run", name: str) -> Values:
    """A channel without which there is no picture. Raises InputError."""
    if name not in run.names:
        raise InputError(
            f"{run.path}: channel {name} is missing; a picture needs {', '.join(Pose._fields)} "
            "and sent_torque"
        )
    return run.channel(name)


def _finite_ticks(channels: list[Values]) -> int:
    finite = np.logical_and.reduce([np.isfinite(values) for values in channels])
    return len(finite) if finite.all() else int(finite.argmin())
