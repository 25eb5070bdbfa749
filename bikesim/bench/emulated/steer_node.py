"""An emulated steering sensor node, as a pure state machine."""

from bikesim.bench.calibration import (
    Command,
    NodeCalibration,
    Parameter,
    Result,
    decode_command,
    encode_reply,
)
from bikesim.bench.database import STEER_COMMAND, STEER_DIAG, STEER_STATE, cycle_time, message
from bikesim.bench.emulated.device import Periodic
from bikesim.bench.frame import Frame
from bikesim.bench.sensor_node import SteerDiag, SteerEncoder, SteerStatus, encode_diag

# A potentiometer of 330 deg straight ahead in its middle; a gyro of ±300 deg/s.
USUAL_CALIBRATION = NodeCalibration(0.5, 5.76, 0.5, 10.47, 3.3)

_GOOD = (0.02, 0.98)  # of the raw values


class EmulatedSteerNode:
    """`steer` [rad] and `steer_rate` [rad/s] are set from outside, right positive.

    `sensors` is what the potentiometer and the gyro really are; `stored` what the node takes them
    for, None if it has never been calibrated. `pot` and `gyro`, where not None, are raw values in
    place of those that the motion gives: a wire that is broken, a wiper that sticks.
    """

    def __init__(
        self,
        *,
        sensors: NodeCalibration = USUAL_CALIBRATION,
        stored: NodeCalibration | None = USUAL_CALIBRATION,
    ) -> None:
        self.sensors, self.stored = sensors, stored
        self.steer = self.steer_rate = 0.0
        self.pot: float | None = None
        self.gyro: float | None = None
        self.reference_voltage = sensors.reference_voltage
        self.estop_closed = True
        self._pending = list((stored or USUAL_CALIBRATION).counts())
        self._encoder = SteerEncoder()
        self._state = Periodic(cycle_time(message(STEER_STATE)))
        self._diag = Periodic(cycle_time(message(STEER_DIAG)))
        self._command_id = message(STEER_COMMAND).frame_id

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        """See `Device`."""
        del time
        command = decode_command(frame.data) if frame.id == self._command_id else None
        if command is None:
            return []
        result = self._do(command.command, command.parameter, command.value)
        known = command.parameter in [*Parameter]
        counts = self._pending if command.command == Command.WRITE else self._acting.counts()
        value = counts[command.parameter] if known and command.command != Command.STORE else 0
        return [encode_reply(command._replace(result=result, value=value))]

    def advance(self, time: float) -> list[Frame]:
        """See `Device`."""
        frames = []
        if self._state.due(time):
            frames.append(self._steer_state(time))
        if self._diag.due(time):
            diag = SteerDiag(self._raw_pot(), self._raw_gyro(), self.reference_voltage, 25, 1)
            frames.append(encode_diag(diag))
        return frames

    @property
    def _acting(self) -> NodeCalibration:
        return self.stored or USUAL_CALIBRATION

    def _steer_state(self, time: float) -> Frame:
        acting, pot, gyro = self._acting, self._raw_pot(), self._raw_gyro()
        nominal = acting.reference_voltage
        status = SteerStatus(
            pot_ok=self.stored is not None and _GOOD[0] <= pot <= _GOOD[1],
            gyro_ok=self.stored is not None and _GOOD[0] <= gyro <= _GOOD[1],
            vref_ok=abs(self.reference_voltage - nominal) <= 0.05 * nominal,
            estop_closed=self.estop_closed,
        )
        steer = (pot - acting.pot_zero) * acting.angle_scale
        rate = (gyro - acting.gyro_zero) * acting.rate_scale
        return self._encoder.encode(time, steer, rate, status)

    def _raw_pot(self) -> float:
        turned = self.sensors.pot_zero + self.steer / self.sensors.angle_scale
        return _clipped(turned if self.pot is None else self.pot)

    def _raw_gyro(self) -> float:
        turning = self.sensors.gyro_zero + self.steer_rate / self.sensors.rate_scale
        return _clipped(turning if self.gyro is None else self.gyro)

    def _do(self, command: int, parameter: int, value: int) -> Result:
        if command not in [*Command]:
            return Result.NO_SUCH_COMMAND
        if command in (Command.READ, Command.WRITE) and parameter not in [*Parameter]:
            return Result.NO_SUCH_PARAMETER
        if command == Command.READ:
            return Result.DONE
        if self.estop_closed:
            return Result.NOT_IDLE
        if command == Command.WRITE:
            self._pending[parameter] = value
        elif command == Command.STORE:
            self.stored = NodeCalibration.of_counts(tuple(self._pending))
        else:
            self._pending = list(self._acting.counts())
        return Result.DONE


def _clipped(raw: float) -> float:
    return max(0.0, min(65535 / 65536, raw))
