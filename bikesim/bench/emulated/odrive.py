"""An emulated ODrive in torque mode, as a pure state machine."""

import math
import struct
from dataclasses import dataclass

from bikesim.bench.emulated.device import Periodic
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import (
    PASSTHROUGH,
    TORQUE_CONTROL,
    AxisError,
    AxisState,
    Command,
    message_id,
    set_input_torque,
)
from bikesim.bench.odrive_settings import ODriveSettings

_HEARTBEAT = struct.Struct("<IBB2x")
_TWO_FLOATS = struct.Struct("<ff")
_TWO_WORDS = struct.Struct("<II")
_POSITION_CONTROL = 3
_SUCCESS, _DISARMED = 0, 3  # results of a procedure
_ERRORS_PERIOD = 0.1  # s


@dataclass(frozen=True, slots=True)
class ODriveConfiguration:
    """What is set in an ODrive by USB: watchdog time-out [s] (None: off) and periods [s].

    `any_frame_feeds`: each frame to it feeds its watchdog, as with firmware 0.5; else only a
    torque command does.
    """

    torque_constant: float
    watchdog_timeout: float | None
    heartbeat_period: float = 0.1
    estimates_period: float = 0.001
    torques_period: float = 0.002
    any_frame_feeds: bool = False

    @classmethod
    def of_profile(cls, drive: ODriveSettings) -> "ODriveConfiguration":
        """The one that a profile expects."""
        return cls(
            drive.torque_constant,
            drive.watchdog_timeout,
            drive.heartbeat_period,
            drive.estimates_period,
            drive.torques_period,
        )


class EmulatedODrive:
    """`angle` [rad] and `rate` [rad/s] of its shaft are set from outside; `torque` is its own.

    `strength`: what share of the torque that it is told its motor gives; `offset` [N m]: what it
    measures beside that.
    """

    def __init__(self, node: int, configuration: ODriveConfiguration) -> None:
        self.node, self._set = node, configuration
        self.angle = self.rate = 0.0
        self.strength, self.offset = 1.0, 0.0
        self.state = AxisState.IDLE
        self.errors = self.disarm_reason = 0
        self._result = _SUCCESS
        self._modes = (_POSITION_CONTROL, PASSTHROUGH)
        self._velocity_limit, self._current_limit = 2.0, 10.0  # turns/s, A
        self._input_torque = 0.0
        self._fed: float | None = None
        self._cyclic = {
            Command.HEARTBEAT: Periodic(configuration.heartbeat_period),
            Command.GET_ERROR: Periodic(_ERRORS_PERIOD),
            Command.GET_ENCODER_ESTIMATES: Periodic(configuration.estimates_period),
            Command.GET_TORQUES: Periodic(configuration.torques_period),
        }

    @property
    def torque(self) -> float:
        """What acts on the shaft [N m]."""
        enabled = self.state is AxisState.CLOSED_LOOP_CONTROL
        if not enabled or self._modes != (TORQUE_CONTROL, PASSTHROUGH):
            return 0.0
        limit = self._current_limit * self._set.torque_constant
        return self.strength * max(-limit, min(limit, self._input_torque))

    def fail(self, error: AxisError) -> None:
        """An error of its own: the motor is free at once."""
        self.errors |= error
        if self.state is not AxisState.IDLE:
            self.state = AxisState.IDLE
            self.disarm_reason = error
            self._result = _DISARMED

    def disable(self) -> None:
        """By itself, without an error."""
        self.state = AxisState.IDLE

    def break_down(self) -> None:
        """Over current."""
        self.fail(AxisError.DC_BUS_OVER_CURRENT)

    def command_of_another(self) -> Frame:
        """See `DriveDevice`."""
        return set_input_torque(self.node, 0.0)

    def stay_in_mode(self, mode: int | None) -> None:
        """Of control; its cyclic messages do not tell. None: torque."""
        self._modes = (TORQUE_CONTROL if mode is None else mode, PASSTHROUGH)

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        """See `Device`."""
        if frame.id >> 5 != self.node:
            return []
        command = frame.id & 0x1F
        if self._set.any_frame_feeds or command == Command.SET_INPUT_TORQUE:
            self._fed = time
        if frame.remote:
            return self._polled(command)
        self._do(command, frame.data)
        return []

    def advance(self, time: float) -> list[Frame]:
        """See `Device`."""
        self._watch(time)
        due = [command for command, when in self._cyclic.items() if when.due(time)]
        return [self._message(command) for command in due]

    def _watch(self, time: float) -> None:
        if self._fed is None:
            self._fed = time
        timeout = self._set.watchdog_timeout
        if timeout is not None and time - self._fed > timeout:
            self.fail(AxisError.WATCHDOG_TIMER_EXPIRED)
        elif abs(self.rate) / math.tau > 1.2 * self._velocity_limit:
            self.fail(AxisError.VELOCITY_LIMIT_VIOLATION)

    def _do(self, command: int, data: bytes) -> None:
        data = data.ljust(8, b"\0")
        match command:
            case Command.ESTOP:
                self.fail(AxisError.ESTOP_REQUESTED)
            case Command.CLEAR_ERRORS:
                self.errors = 0
            case Command.SET_AXIS_STATE:
                self._request(_TWO_WORDS.unpack(data)[0])
            case Command.SET_CONTROLLER_MODE:
                self._modes = _TWO_WORDS.unpack(data)
            case Command.SET_INPUT_TORQUE:
                self._input_torque = _TWO_FLOATS.unpack(data)[0]
            case Command.SET_LIMITS:
                self._velocity_limit, self._current_limit = _TWO_FLOATS.unpack(data)

    def _request(self, state: int) -> None:
        if state == AxisState.CLOSED_LOOP_CONTROL and not self.errors:
            self.state, self._result = AxisState.CLOSED_LOOP_CONTROL, _SUCCESS
        elif state == AxisState.IDLE:
            self.state, self._result = AxisState.IDLE, _SUCCESS
        else:
            self._result = _DISARMED

    def _polled(self, command: int) -> list[Frame]:
        return [self._message(Command(command))] if command in self._cyclic else []

    def _message(self, command: Command) -> Frame:
        data = {
            Command.HEARTBEAT: lambda: _HEARTBEAT.pack(self.errors, self.state, self._result),
            Command.GET_ERROR: lambda: _TWO_WORDS.pack(self.errors, self.disarm_reason),
            Command.GET_ENCODER_ESTIMATES: self._estimates,
            Command.GET_TORQUES: lambda: _TWO_FLOATS.pack(
                self._input_torque, self.torque + self.offset
            ),
        }[command]()
        return Frame(message_id(self.node, command), data)

    def _estimates(self) -> bytes:
        return _TWO_FLOATS.pack(self.angle / math.tau, self.rate / math.tau)
