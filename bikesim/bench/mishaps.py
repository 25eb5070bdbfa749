"""Things that go wrong on an emulated bench, at given times: for tests, and to see what happens."""

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, Strict, model_validator

from bikesim.bench.frame import Frame
from bikesim.bench.plant import Plant
from bikesim.settings import Settings
from bikesim.textfile import located, read_toml

_SENSORS = (0x110, 0x111, 0x113, 0x120)
_ids = Annotated[tuple[int, ...], Strict(False)]


class Mishap(Settings):
    """One thing that goes wrong; `value` means what the kind makes of it."""

    table: ClassVar[str] = "mishaps"

    kind: Literal[
        "drop", "corrupt", "repeat", "unplug", "master",
        "pot", "slip", "bias", "jump", "estop", "push",
        "silence", "fail", "disable", "mode", "weak", "offset",
    ] = Field(
        description="drop, corrupt or repeat frames; a plug between host and bench that is out "
        "(unplug); another host that commands the drive (master); a potentiometer at a raw value "
        "(pot), that slips [rad/s], a gyro bias [rad/s], an angle that jumps [rad]; an open "
        "emergency stop; somebody who pushes the bar [N m]; a drive that is silent, fails, is "
        "disabled by itself, is in another mode (its number), gives a share of its torque (weak) "
        "or measures more torque than it gives (offset) [N m]."
    )  # fmt: skip
    time: Annotated[float, Field(ge=0)] | None = Field(
        default=None,
        description="Of the ride, when it begins [s]; default: it is always so, before a ride too.",
    )
    duration: Annotated[float, Field(gt=0)] | None = Field(
        default=None, description="How long it lasts [s]; default: as long as the ride."
    )
    value: float = Field(default=0.0, description="See kind.")
    ids: _ids = Field(default=(0x110,), description="Of the frames that are dropped and the like.")

    @model_validator(mode="after")
    def _lasts_from_a_time_on(self) -> Self:
        if self.time is None and self.duration is not None:
            raise ValueError(f"duration = {self.duration:g} s: needs a time at which it begins")
        return self

    def since(self, riding: float | None) -> float | None:
        """For how long it has been so [s], `riding` [s] into a ride (None: there is none); None:
        it is not so.
        """
        if self.time is None:
            return 0.0
        if riding is None or not 0.0 <= riding - self.time < (self.duration or math.inf):
            return None
        return riding - self.time


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
    """Lets them happen to a plant, and to the frames on the wire; asked before each quantum."""

    def __init__(self, plant: Plant, mishaps: Iterable[Mishap]) -> None:
        self._plant, self._all = plant, tuple(mishaps)
        self._on: tuple[Mishap, ...] = ()
        self._last: dict[int, Frame] = {}

    def happen(self, riding: float | None) -> None:
        """At a time of the ride [s]; None: nobody rides."""
        on: list[Mishap] = []
        for mishap in self._all:
            since = mishap.since(riding)
            if since is not None:
                on.append(mishap)
                if mishap.kind in _LASTING:
                    _LASTING[mishap.kind](self._plant, mishap.value, since)
                elif mishap.kind == "fail" and mishap not in self._on:
                    self._plant.drive.break_down()
            elif mishap in self._on:
                self._end(mishap)
        self._on = tuple(on)

    def pass_to_host(self, frame: Frame) -> Iterable[Frame]:
        """What becomes of a frame of the plant."""
        frames = (frame,)
        for mishap in self._on:
            if mishap.kind == "unplug" or (mishap.kind == "silence" and frame.id not in _SENSORS):
                return ()
            if mishap.kind == "master" and frame.id == _SENSORS[0]:
                frames = (frame, self._plant.drive.command_of_another())
            elif frame.id in mishap.ids:
                if mishap.kind == "drop":
                    return ()
                if mishap.kind == "corrupt":
                    frames = (frame._replace(data=bytes((frame.data[0] ^ 0x5A, *frame.data[1:]))),)
                elif mishap.kind == "repeat":
                    frames = (self._last.setdefault(frame.id, frame),)
        return frames

    @property
    def hears_host(self) -> bool:
        """Whether the host's frames reach the plant."""
        return not any(mishap.kind == "unplug" for mishap in self._on)

    def _end(self, mishap: Mishap) -> None:
        if mishap.kind in _OVER:
            _OVER[mishap.kind](self._plant)
        self._last.clear()


def _raw(node, steer: float) -> float:
    return node.sensors.pot_zero + steer / node.sensors.angle_scale


def _pot(plant: Plant, raw: float | None) -> None:
    plant.node.pot = raw


def _turn_pot(plant: Plant, angle: float) -> None:
    plant.node.pot = _raw(plant.node, plant.node.steer + angle)


def _bias(plant: Plant, rate: float) -> None:
    sensors = plant.node.sensors
    plant.node.gyro = sensors.gyro_zero + (plant.node.steer_rate + rate) / sensors.rate_scale


def _good_gyro(plant: Plant) -> None:
    plant.node.gyro = None


def _estop(plant: Plant, *, closed: bool) -> None:
    plant.node.estop_closed = closed


def _push(plant: Plant, torque: float) -> None:
    plant.bar.data.qfrc_applied[0] = torque


def _mode(plant: Plant, mode: int | None) -> None:
    plant.drive.stay_in_mode(mode)


def _weak(plant: Plant, share: float) -> None:
    plant.drive.strength = share


def _offset(plant: Plant, torque: float) -> None:
    plant.drive.offset = plant.at_drive(torque)


# What they do to a plant at each quantum, with their value and for how long they have done so [s].
_LASTING: dict[str, Callable[[Plant, float, float], object]] = {
    "pot": lambda plant, value, since: _pot(plant, value),
    "slip": lambda plant, value, since: _turn_pot(plant, value * since),
    "jump": lambda plant, value, since: _turn_pot(plant, value),
    "bias": lambda plant, value, since: _bias(plant, value),
    "estop": lambda plant, value, since: _estop(plant, closed=False),
    "push": lambda plant, value, since: _push(plant, value),
    "disable": lambda plant, value, since: plant.drive.disable(),
    "mode": lambda plant, value, since: _mode(plant, round(value)),
    "weak": lambda plant, value, since: _weak(plant, value),
    "offset": lambda plant, value, since: _offset(plant, value),
}

# What is done when they are over.
_OVER: dict[str, Callable[[Plant], object]] = {
    "pot": lambda plant: _pot(plant, None),
    "slip": lambda plant: _pot(plant, None),
    "jump": lambda plant: _pot(plant, None),
    "bias": _good_gyro,
    "estop": lambda plant: _estop(plant, closed=True),
    "push": lambda plant: _push(plant, 0.0),
    "mode": lambda plant: _mode(plant, None),
    "weak": lambda plant: _weak(plant, 1.0),
    "offset": lambda plant: _offset(plant, 0.0),
}
