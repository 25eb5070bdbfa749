"""The speed sensor at the wheel or the flywheel: WheelSpeed, decoded and encoded."""

from typing import Annotated, ClassVar, Literal, NamedTuple

from pydantic import Field

from bikesim.bench.continuity import BadFrame
from bikesim.bench.database import WHEEL_SPEED
from bikesim.bench.frame import Frame
from bikesim.bench.sealed import SealedFrames, SealingFrames, saturated
from bikesim.settings import Settings

_OWN = "hH"  # rate, pulses
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
        self._frames = SealedFrames(WHEEL_SPEED, _OWN)
        self.id = self._frames.id
        self._scale = self._frames.scale("WheelRate") * settings.radius * settings.direction

    def decode(self, data: bytes, arrival: float) -> WheelReading | BadFrame:
        """For a frame's data and when it came on the host's clock [s]. Raises nothing."""
        opened = self._frames.opened(data, arrival)
        if isinstance(opened, BadFrame):
            return opened
        (_, status, rate, pulses, _), passage = opened
        ok = status & _SENSOR_OK != 0
        return WheelReading(passage.time, rate * self._scale, ok, pulses, passage.lost)


class WheelEncoder:
    """Encodes WheelSpeed as the node does."""

    def __init__(self, settings: WheelSettings) -> None:
        self._frames = SealingFrames(WHEEL_SPEED, _OWN)
        self.id = self._frames.id
        self._scale = self._frames.scale("WheelRate") * settings.radius * settings.direction

    def encode(self, time: float, speed: float, pulses: int, sensor_ok: bool = True) -> Frame:
        """The next frame; time [s] on the node's clock, speed [m/s]."""
        status = _SENSOR_OK if sensor_ok else 0
        return self._frames.sealed(status, time, saturated(speed / self._scale), pulses & 0xFFFF)
