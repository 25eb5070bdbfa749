"""Things that go wrong on an emulated bench, at given times: for tests, and to see what happens."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field, Strict

from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import AxisError
from bikesim.bench.plant import Plant
from bikesim.settings import Settings
from bikesim.textfile import located, read_toml

_SHORT_CIRCUIT = 0x2310  # emergency error code: continuous over current
_ids = Annotated[tuple[int, ...], Strict(False)]


class Mishap(Settings):
    """One thing that goes wrong; `value` means what the kind makes of it."""

    table: ClassVar[str] = "mishaps"

    kind: Literal[
        "drop", "corrupt", "repeat", "pot", "slip", "bias", "jump", "estop", "silence", "fail"
    ] = Field(
        description="drop, corrupt or repeat frames; a potentiometer at a raw value (pot), that "
        "slips [rad/s], a gyro bias [rad/s], an angle that jumps [rad]; an open emergency stop; a "
        "drive that is silent, or fails."
    )
    time: Annotated[float, Field(ge=0)] = Field(description="Of the ride, when it begins [s].")
    duration: Annotated[float, Field(gt=0)] | None = Field(
        default=None, description="How long it lasts [s]; default: for ever."
    )
    value: float = Field(default=0.0, description="See kind.")
    ids: _ids = Field(default=(0x110,), description="Of the frames that are dropped and the like.")


class _File(Settings):
    mishaps: Annotated[tuple[Mishap, ...], Strict(False)] = Field(
        default=(), description="What goes wrong."
    )


def read_mishaps(path: Path) -> tuple[Mishap, ...]:
    """From a TOML file with [[mishaps]]. Raises InputError."""
    keys = read_toml(path, "mishaps")
    with located(f"mishaps {path}"):
        return _File(**keys).mishaps


class Mishaps:
    """Lets them happen to a plant, and to the frames that leave it; asked before each quantum."""

    def __init__(self, plant: Plant, mishaps: Iterable[Mishap]) -> None:
        self._plant, self._all = plant, tuple(mishaps)
        self._on: tuple[Mishap, ...] = ()
        self._last: dict[int, Frame] = {}

    def happen(self, time: float) -> None:
        """At a time of the ride [s]."""
        if not self._all:
            return
        on = tuple(m for m in self._all if m.time <= time < m.time + (m.duration or math.inf))
        for mishap in self._on:
            if mishap not in on:
                self._end(mishap)
        for mishap in on:
            self._go_on(mishap, time - mishap.time, mishap not in self._on)
        self._on = on

    def on_the_wire(self, frame: Frame, time: float = 0.0) -> Iterable[Frame]:
        """What becomes of a frame of the plant."""
        del time
        for mishap in self._on:
            if mishap.kind == "silence" and frame.id not in (0x110, 0x111, 0x120):
                return ()
            if frame.id in mishap.ids:
                if mishap.kind == "drop":
                    return ()
                if mishap.kind == "corrupt":
                    return (frame._replace(data=bytes((frame.data[0] ^ 0x5A, *frame.data[1:]))),)
                if mishap.kind == "repeat":
                    return (self._last.setdefault(frame.id, frame),)
        return (frame,)

    def _go_on(self, mishap: Mishap, since: float, first: bool) -> None:
        node = self._plant.node
        if mishap.kind == "pot":
            node.pot = mishap.value
        elif mishap.kind == "slip":
            node.pot = _raw(node, node.steer + mishap.value * since)
        elif mishap.kind == "jump":
            node.pot = _raw(node, node.steer + mishap.value)
        elif mishap.kind == "bias":
            s = node.sensors
            node.gyro = s.gyro_zero + (node.steer_rate + mishap.value) / s.rate_scale
        elif mishap.kind == "estop":
            node.estop_closed = False
        elif mishap.kind == "fail" and first:
            self._fail()

    def _fail(self) -> None:
        drive = self._plant.drive
        if isinstance(drive, EmulatedDrive):
            drive.fail(_SHORT_CIRCUIT, 0.0)
        else:
            drive.fail(AxisError.DC_BUS_OVER_CURRENT)

    def _end(self, mishap: Mishap) -> None:
        node = self._plant.node
        if mishap.kind in ("pot", "slip", "jump"):
            node.pot = None
        elif mishap.kind == "bias":
            node.gyro = None
        elif mishap.kind == "estop":
            node.estop_closed = True
        self._last.clear()


def _raw(node, steer: float) -> float:
    return node.sensors.pot_zero + steer / node.sensors.angle_scale
