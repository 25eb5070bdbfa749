"""What a bench knows of its bar: from the sensor node, or from the drive where there is no node."""

import math
from typing import NamedTuple, Protocol

from bikesim.bench.continuity import BadFrame, Flaw
from bikesim.bench.drive import Drive
from bikesim.bench.frame import Frame
from bikesim.bench.sensor_node import SteerDecoder, SteerReading


class BarView(NamedTuple):
    """The bar at a tick: the newest good sample, and what came since the last tick.

    `fresh`: whether a good one did. `age` [s] on the host's clock; `lost` frames in all.
    """

    steer: float
    steer_rate: float
    sample_time: float
    fresh: bool
    age: float
    bad_frames: int
    frozen_frames: int
    lost: int
    pot_ok: bool
    gyro_ok: bool
    vref_ok: bool
    estop_closed: bool


class Bar(Protocol):
    """Where steer angle and rate come from."""

    @property
    def ids(self) -> frozenset[int]: ...

    def receive(self, frame: Frame, time: float) -> None: ...

    def view(self, time: float) -> BarView:
        """At a tick; what is fresh is so once."""
        ...


class NodeBar:
    """The steering sensor node. Good frames in a row count bad ones down to none."""

    def __init__(self) -> None:
        self._decoder = SteerDecoder()
        self._reading = SteerReading(0.0, 0.0, 0.0, True, True, True, True, 0)
        self._arrival = -math.inf
        self._fresh = False
        self._bad = self._frozen = self._lost = 0

    @property
    def ids(self) -> frozenset[int]:
        return frozenset((self._decoder.id,))

    def receive(self, frame: Frame, time: float) -> None:
        reading = self._decoder.decode(frame.data, time)
        if isinstance(reading, BadFrame):
            if reading.flaw in (Flaw.REPEATED, Flaw.FROZEN):
                self._frozen += 1
            else:
                self._bad += 1
            return
        self._reading, self._arrival, self._fresh = reading, time, True
        self._bad = self._frozen = 0
        self._lost += reading.lost

    def view(self, time: float) -> BarView:
        r, fresh = self._reading, self._fresh
        self._fresh = False
        return BarView(
            r.steer, r.steer_rate, r.time, fresh, time - self._arrival,
            self._bad, self._frozen, self._lost,
            r.pot_ok, r.gyro_ok, r.vref_ok, r.estop_closed,
        )  # fmt: skip


class DriveBar:
    """The drive's own encoder. It has no second sensor, so nothing to compare; see docs/bench.md.

    `zero` [rad]: what the encoder says when the bar is straight.
    """

    def __init__(self, drive: Drive, zero: float) -> None:
        self._drive, self._zero = drive, zero
        self._arrival = -math.inf
        self.ids: frozenset[int] = frozenset()

    def receive(self, frame: Frame, time: float) -> None:
        """Its frames are the drive's."""

    def view(self, time: float) -> BarView:
        seen = self._drive.view(time)
        arrival = time - seen.age
        # An age is a difference of times: the same arrival comes out of it as nearly the same.
        fresh = arrival > self._arrival + 1e-7
        self._arrival = arrival if fresh else self._arrival
        return BarView(
            seen.steer - self._zero, seen.steer_rate, arrival, fresh, seen.age,
            0, 0, 0, True, True, True, True,
        )  # fmt: skip
