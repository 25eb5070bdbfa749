"""The calibration stored in the steering sensor node: read, written, stored over CAN.

SteerCommand and SteerReply of `hardware/can/steer_node.dbc`. The node refuses changes while its
emergency-stop circuit is closed, so that no angle jumps while a drive has power.
"""

import struct
from enum import IntEnum
from typing import NamedTuple

from bikesim.bench.database import STEER_COMMAND, STEER_REPLY, frame_crc, message
from bikesim.bench.frame import Frame
from bikesim.bench.link import Link, until
from bikesim.errors import InputError

_LAYOUT = struct.Struct("<BBBBi")  # CRC, command and sequence, parameter, result, value
_RESPONSE_TIME = 0.2  # s; storing erases a page of memory, some 40 ms
_ATTEMPTS = 3


class Command(IntEnum):
    """What the node may be asked. What is written acts when it is stored; until then forget."""

    READ = 1
    WRITE = 2
    STORE = 3
    FORGET = 4


class Parameter(IntEnum):
    """Of the calibration, as the node counts it."""

    POT_ZERO = 0  # 1/65536 of the reference, straight ahead
    ANGLE_SCALE = 1  # urad over the whole reference; negative: the potentiometer is mirrored
    GYRO_ZERO = 2  # 1/65536 of the converter's range, at rest
    RATE_SCALE = 3  # urad/s over the whole range; negative: the gyro is mirrored
    REFERENCE_VOLTAGE = 4  # mV, as it should be


class Result(IntEnum):
    """What the node answered."""

    DONE = 0
    NOT_IDLE = 1
    NO_SUCH_PARAMETER = 2
    OUT_OF_RANGE = 3
    MEMORY_FAILED = 4
    NO_SUCH_COMMAND = 5


class Exchange(NamedTuple):
    """A command or the answer to it, which has the same layout; of a command the result is 0.

    `value`, in the parameter's own unit: to write, or what the parameter now is.
    """

    sequence: int  # 0 to 15; comes back in the answer
    command: int
    parameter: int = 0
    result: int = 0
    value: int = 0


class NodeCalibration(NamedTuple):
    """The node's calibration in SI.

    steer = angle_scale (pot - pot_zero) and steer rate = rate_scale (gyro - gyro_zero) [rad,
    rad/s], with pot and gyro raw, 0 to 1; right is positive. `reference_voltage` [V] is what the
    potentiometer should have.
    """

    pot_zero: float
    angle_scale: float
    gyro_zero: float
    rate_scale: float
    reference_voltage: float

    def counts(self) -> tuple[int, ...]:
        """As the node counts them, in the order of `Parameter`."""
        return tuple(round(v * u) for v, u in zip(self, _COUNTS_PER_UNIT, strict=True))

    @classmethod
    def of_counts(cls, counts: tuple[int, ...]) -> "NodeCalibration":
        """From what the node has."""
        return cls(*(count / unit for count, unit in zip(counts, _COUNTS_PER_UNIT, strict=True)))


_COUNTS_PER_UNIT = (65536, 1e6, 65536, 1e6, 1e3)

_REFUSALS = {
    Result.NOT_IDLE: "press the emergency stop first: a calibration changes only without power",
    Result.NO_SUCH_PARAMETER: "its firmware does not know this parameter",
    Result.OUT_OF_RANGE: "the value is out of range",
    Result.MEMORY_FAILED: "its memory did not keep it",
    Result.NO_SUCH_COMMAND: "its firmware does not know this command",
}


def encode_command(command: Exchange) -> Frame:
    """SteerCommand."""
    return _encode(STEER_COMMAND, command)


def encode_reply(reply: Exchange) -> Frame:
    """SteerReply."""
    return _encode(STEER_REPLY, reply)


def decode_command(data: bytes) -> Exchange | None:
    """SteerCommand; None if it is damaged."""
    return _decode(STEER_COMMAND, data)


def decode_reply(data: bytes) -> Exchange | None:
    """SteerReply; None if it is damaged."""
    return _decode(STEER_REPLY, data)


def _encode(name: str, told: Exchange) -> Frame:
    layout = message(name)
    first = told.command << 4 | told.sequence
    data = _LAYOUT.pack(0, first, told.parameter, told.result, told.value)
    return Frame(layout.frame_id, frame_crc(layout).seal(data))


def _decode(name: str, data: bytes) -> Exchange | None:
    if len(data) != 8 or frame_crc(message(name))(data) != data[0]:
        return None
    _, first, parameter, result, value = _LAYOUT.unpack(data)
    return Exchange(first & 0x0F, first >> 4, parameter, result, value)


class CalibrationClient:
    """Reads and changes the node's calibration over a link. Raises InputError."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._reply_id = message(STEER_REPLY).frame_id
        self._sequence = 0

    def read(self) -> NodeCalibration:
        """The one that acts."""
        return NodeCalibration.of_counts(tuple(self._ask(Command.READ, p) for p in Parameter))

    def change(self, calibration: NodeCalibration) -> None:
        """Stores another one, whole or not at all; it acts from then on."""
        for parameter, count in zip(Parameter, calibration.counts(), strict=True):
            if not -(2**31) <= count < 2**31:
                raise InputError(f"sensor node: {_told(parameter)} = {count} does not fit")
            self._ask(Command.WRITE, parameter, count)
        self._ask(Command.STORE)
        kept = self.read()
        if kept.counts() != calibration.counts():
            raise InputError(f"sensor node: has {kept} after {calibration} was stored")

    def _ask(self, command: Command, parameter: int = 0, value: int = 0) -> int:
        self._sequence = (self._sequence + 1) % 16
        asked = Exchange(self._sequence, command, parameter, 0, value)
        for _ in range(_ATTEMPTS):
            self._link.send(encode_command(asked))
            reply = self._answer(asked)
            if reply is not None:
                return self._accepted(reply)
        raise InputError("sensor node: does not answer a calibration command (0x112)")

    def _answer(self, asked: Exchange) -> Exchange | None:
        for frame in until(self._link, self._link.now() + _RESPONSE_TIME):
            if frame.id != self._reply_id:
                continue
            reply = decode_reply(frame.data)
            if reply and reply[:3] == asked[:3]:
                return reply
        return None

    def _accepted(self, reply: Exchange) -> int:
        if reply.result == Result.DONE:
            return reply.value
        asked = Command(reply.command).name.lower()
        if reply.command in (Command.READ, Command.WRITE):
            asked += f" {_told(reply.parameter)}"
        known = reply.result in _REFUSALS
        why = _REFUSALS[Result(reply.result)] if known else f"result {reply.result}"
        raise InputError(f"sensor node: refused to {asked}: {why}")


def _told(parameter: int) -> str:
    return Parameter(parameter).name.lower().replace("_", " ")
