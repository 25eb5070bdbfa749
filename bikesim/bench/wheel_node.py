"""The speed sensor at the wheel or the flywheel: WheelSpeed, decoded and encoded."""

import struct
from typing import Annotated, ClassVar, Literal, NamedTuple

from pydantic import Field

from bikesim.bench.continuity import COUNTS, TIME_UNIT, BadFrame, Continuity, Flaw
from bikesim.bench.database import WHEEL_SPEED, cycle_time, frame_crc, message, scale
from bikesim.bench.frame import Frame
from bikesim.bench.sensor_node import saturated
from bikesim.settings import Settings

_LAYOUT = struct.Struct("<BBhHH")  # CRC, status and counter, rate, pulses, sample time
_SENSOR_OK = 0x10


class WheelSettings(Settings):
    """Where the speed sensor sits: what the bicycle moves for a radian of it."""

    table: ClassVar[str] = "wheel"

    radius: Annotated[float, Field(ge=0.01, le=2)] = Field(
        description="Road per radian of the sensor's wheel [m]; of a flywheel: with its gearing."
    )
    direction: Literal[1, -1] = Field(
        default=1, description="1: the sensor counts forwards; -1: it counts backwards."
    )


class WheelReading(NamedTuple):
    """A good WheelSpeed: sample time on the node's clock [s], the bicycle's speed [m/s].

    `pulses` of the sensor, wrapping around at 65536; `lost`: frames missing just before.
    """

    time: float
    speed: float
    sensor_ok: bool
    pulses: int
    lost: int


class WheelDecoder:
    """Decodes one node's WheelSpeed frames, in the order in which they came."""

    def __init__(self, settings: WheelSettings) -> None:
        wheel = message(WHEEL_SPEED)
        self.id = wheel.frame_id
        self._crc = frame_crc(wheel)
        self._scale = scale(wheel, "WheelRate") * settings.radius * settings.direction
        self._continuity = Continuity(cycle_time(wheel))

    def decode(self, data: bytes, arrival: float) -> WheelReading | BadFrame:
        """For a frame's data and when it came on the host's clock [s]. Raises nothing."""
        if len(data) != 8:
            return BadFrame(Flaw.LENGTH)
        crc, status, rate, pulses, ticks = _LAYOUT.unpack(data)
        if crc != self._crc(data):
            return BadFrame(Flaw.CRC)
        passage = self._continuity.follow(status & 0x0F, ticks, arrival)
        if isinstance(passage, Flaw):
            return BadFrame(passage)
        ok = status & _SENSOR_OK != 0
        return WheelReading(passage.time, rate * self._scale, ok, pulses, passage.lost)


class WheelEncoder:
    """Encodes WheelSpeed as the node does."""

    def __init__(self, settings: WheelSettings) -> None:
        wheel = message(WHEEL_SPEED)
        self.id = wheel.frame_id
        self._crc = frame_crc(wheel)
        self._scale = scale(wheel, "WheelRate") * settings.radius * settings.direction
        self._counter = 0

    def encode(self, time: float, speed: float, pulses: int, sensor_ok: bool = True) -> Frame:
        """The next frame; time [s] on the node's clock, speed [m/s]."""
        bits = self._counter | (_SENSOR_OK if sensor_ok else 0)
        self._counter = (self._counter + 1) % COUNTS
        ticks = round(time / TIME_UNIT) & 0xFFFF
        data = _LAYOUT.pack(0, bits, saturated(speed / self._scale), pulses & 0xFFFF, ticks)
        return Frame(self.id, self._crc.seal(data))
