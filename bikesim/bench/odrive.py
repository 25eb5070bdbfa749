"""The frames between host and an ODrive (CANSimple of firmware 0.6), little-endian.

Only cyclic messages are read: on some firmware every frame to the ODrive, a request for a value
too, feeds its watchdog, and a host that polls keeps an old torque alive.
"""

import struct
from enum import IntEnum, IntFlag
from typing import NamedTuple

from bikesim.bench.frame import Frame


class Command(IntEnum):
    """The lower five bits of an identifier."""

    HEARTBEAT = 0x01
    ESTOP = 0x02
    GET_ERROR = 0x03
    SET_AXIS_STATE = 0x07
    GET_ENCODER_ESTIMATES = 0x09
    SET_CONTROLLER_MODE = 0x0B
    SET_INPUT_TORQUE = 0x0E
    SET_LIMITS = 0x0F
    CLEAR_ERRORS = 0x18
    GET_TORQUES = 0x1C


class AxisState(IntEnum):
    """What an axis does, as far as a bench is concerned."""

    IDLE = 1
    CLOSED_LOOP_CONTROL = 8


TORQUE_CONTROL = 1  # control mode
PASSTHROUGH = 1  # input mode


class AxisError(IntFlag):
    """Bits of the errors of an axis."""

    INITIALIZING = 0x1
    SYSTEM_LEVEL = 0x2
    TIMING_ERROR = 0x4
    MISSING_ESTIMATE = 0x8
    BAD_CONFIG = 0x10
    DRV_FAULT = 0x20
    MISSING_INPUT = 0x40
    DC_BUS_OVER_VOLTAGE = 0x100
    DC_BUS_UNDER_VOLTAGE = 0x200
    DC_BUS_OVER_CURRENT = 0x400
    DC_BUS_OVER_REGEN_CURRENT = 0x800
    CURRENT_LIMIT_VIOLATION = 0x1000
    MOTOR_OVER_TEMP = 0x2000
    INVERTER_OVER_TEMP = 0x4000
    VELOCITY_LIMIT_VIOLATION = 0x8000
    POSITION_LIMIT_VIOLATION = 0x10000
    WATCHDOG_TIMER_EXPIRED = 0x01000000
    ESTOP_REQUESTED = 0x02000000
    SPINOUT_DETECTED = 0x04000000
    BRAKE_RESISTOR_DISARMED = 0x08000000
    THERMISTOR_DISCONNECTED = 0x10000000
    CALIBRATION_ERROR = 0x40000000


def errors_told(errors: int) -> str:
    """The errors of an axis for a person."""
    known = [bit.name for bit in AxisError if errors & bit]
    rest = errors & ~sum(AxisError)
    named = [name.lower().replace("_", " ") for name in known if name]
    return ", ".join(named + ([f"{rest:#x}"] if rest else [])) or "no error"


class AxisHeartbeat(NamedTuple):
    """Errors, state of the axis, result of the last procedure."""

    errors: int
    state: int
    result: int


class AxisErrors(NamedTuple):
    """What is wrong now, and why the axis was disarmed last."""

    active: int
    disarm_reason: int


class Estimates(NamedTuple):
    """Of the encoder: position [turns] and velocity [turns/s] of the motor."""

    position: float
    velocity: float


class Torques(NamedTuple):
    """At the motor's shaft: what is aimed at and what is estimated [N m]."""

    target: float
    estimate: float


_HEARTBEAT = struct.Struct("<IBB2x")
_TWO_WORDS = struct.Struct("<II")
_TWO_FLOATS = struct.Struct("<ff")
_WORD = struct.Struct("<I")
_TORQUE = struct.Struct("<f4x")


def message_id(node: int, command: Command) -> int:
    """The identifier of a message of a node (0 to 62)."""
    return node << 5 | command


def ids_from_odrive(node: int) -> tuple[int, ...]:
    """What it sends."""
    cyclic = (
        Command.HEARTBEAT, Command.GET_ERROR, Command.GET_ENCODER_ESTIMATES, Command.GET_TORQUES,
    )  # fmt: skip
    return tuple(message_id(node, command) for command in cyclic)


def ids_to_odrive(node: int) -> tuple[int, ...]:
    """What the host sends."""
    sent = set(Command) - {identifier & 0x1F for identifier in ids_from_odrive(node)}
    return tuple(message_id(node, command) for command in sorted(sent))


def unpack_heartbeat(data: bytes) -> AxisHeartbeat | None:
    """None if it is none."""
    return AxisHeartbeat._make(_HEARTBEAT.unpack(data)) if len(data) == 8 else None


def unpack_errors(data: bytes) -> AxisErrors | None:
    """None if it is none."""
    return AxisErrors._make(_TWO_WORDS.unpack(data)) if len(data) == 8 else None


def unpack_estimates(data: bytes) -> Estimates | None:
    """None if it is none."""
    return Estimates._make(_TWO_FLOATS.unpack(data)) if len(data) == 8 else None


def unpack_torques(data: bytes) -> Torques | None:
    """None if it is none."""
    return Torques._make(_TWO_FLOATS.unpack(data)) if len(data) == 8 else None


def clear_errors(node: int) -> Frame:
    """Forgets what was wrong; does not enable."""
    return Frame(message_id(node, Command.CLEAR_ERRORS), b"\0")


def estop(node: int) -> Frame:
    """Disarms at once, with an error."""
    return Frame(message_id(node, Command.ESTOP))


def set_axis_state(node: int, state: AxisState) -> Frame:
    """Asks for a state."""
    return Frame(message_id(node, Command.SET_AXIS_STATE), _WORD.pack(state))


def set_torque_mode(node: int) -> Frame:
    """Torque control, without a ramp or a filter before it."""
    data = _TWO_WORDS.pack(TORQUE_CONTROL, PASSTHROUGH)
    return Frame(message_id(node, Command.SET_CONTROLLER_MODE), data)


def set_limits(node: int, velocity: float, current: float) -> Frame:
    """Of the motor: velocity [turns/s] and current [A]."""
    return Frame(message_id(node, Command.SET_LIMITS), _TWO_FLOATS.pack(velocity, current))


def pack_torque(torque: float) -> bytes:
    """Of Set_Input_Torque: at the motor's shaft [N m]."""
    return _TORQUE.pack(torque)


def set_input_torque(node: int, torque: float) -> Frame:
    """At the motor's shaft [N m]. Feeds the watchdog."""
    return Frame(message_id(node, Command.SET_INPUT_TORQUE), pack_torque(torque))
