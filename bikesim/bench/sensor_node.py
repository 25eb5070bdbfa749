"""The steering sensor node: SteerState and SteerDiag, decoded and encoded.

Layout, units and signs are those of `hardware/can/steer_node.dbc`. SteerState, of which a tick
has one, is unpacked with `struct` and the database's scales: with CRC, counter and time that is
2.3 us, where cantools takes 2.8 us for the decoding alone. A test holds the two together.
"""

from typing import NamedTuple

from bikesim.bench.continuity import BadFrame
from bikesim.bench.database import STEER_DIAG, STEER_STATE, decoded, message
from bikesim.bench.frame import Frame
from bikesim.bench.sealed import SealedFrames, SealingFrames, saturated

_OWN = "hh"  # angle, rate
_POT_OK, _GYRO_OK, _VREF_OK, _ESTOP_CLOSED = 0x10, 0x20, 0x40, 0x80


class SteerReading(NamedTuple):
    """A good SteerState: sample time on the node's clock [s], angle [rad], rate [rad/s].

    Right is positive. `lost`: frames missing just before this one.
    """

    time: float
    steer: float
    steer_rate: float
    pot_ok: bool
    gyro_ok: bool
    vref_ok: bool
    estop_closed: bool
    lost: int


class SteerStatus(NamedTuple):
    """The status bits of SteerState."""

    pot_ok: bool = True
    gyro_ok: bool = True
    vref_ok: bool = True
    estop_closed: bool = True


class SteerDiag(NamedTuple):
    """What a person who looks for a fault wants to see.

    Raw potentiometer (part of its reference) and gyro (part of its range), 0 to 1; the
    reference [V]; temperature [deg C]; the firmware's number.
    """

    pot: float
    gyro: float
    reference_voltage: float
    temperature: int
    firmware: int


ALL_GOOD = SteerStatus()


class SteerDecoder:
    """Decodes one node's SteerState frames, in the order in which they came."""

    def __init__(self) -> None:
        self._frames = SealedFrames(STEER_STATE, _OWN)
        self.id = self._frames.id
        self._angle, self._rate = self._frames.scale("SteerAngle"), self._frames.scale("SteerRate")

    def decode(self, data: bytes, arrival: float) -> SteerReading | BadFrame:
        """For a frame's data and when it came on the host's clock [s]. Raises nothing."""
        opened = self._frames.opened(data, arrival)
        if isinstance(opened, BadFrame):
            return opened
        (_, status, angle, rate, _), passage = opened
        return SteerReading(
            passage.time,
            angle * self._angle,
            rate * self._rate,
            status & _POT_OK != 0,
            status & _GYRO_OK != 0,
            status & _VREF_OK != 0,
            status & _ESTOP_CLOSED != 0,
            passage.lost,
        )


class SteerEncoder:
    """Encodes SteerState as the node does: counts, saturates, seals."""

    def __init__(self) -> None:
        self._frames = SealingFrames(STEER_STATE, _OWN)
        self.id = self._frames.id
        self._angle, self._rate = self._frames.scale("SteerAngle"), self._frames.scale("SteerRate")

    def encode(
        self, time: float, steer: float, steer_rate: float, status: SteerStatus = ALL_GOOD
    ) -> Frame:
        """The next frame; time [s] on the node's clock, angle [rad], rate [rad/s]."""
        bits = 0
        for bit, is_set in zip((_POT_OK, _GYRO_OK, _VREF_OK, _ESTOP_CLOSED), status, strict=True):
            bits |= bit if is_set else 0
        angle, rate = saturated(steer / self._angle), saturated(steer_rate / self._rate)
        return self._frames.sealed(bits, time, angle, rate)


def decode_diag(data: bytes) -> SteerDiag:
    """A SteerDiag frame of 8 bytes."""
    value = decoded(message(STEER_DIAG), data)
    return SteerDiag(
        pot=value["PotRaw"],
        gyro=value["GyroRaw"],
        reference_voltage=value["ReferenceVoltage"],
        temperature=int(value["Temperature"]),
        firmware=int(value["Firmware"]),
    )


def encode_diag(diag: SteerDiag) -> Frame:
    """The frame of a SteerDiag."""
    state = message(STEER_DIAG)
    signals = {
        "PotRaw": diag.pot,
        "GyroRaw": diag.gyro,
        "ReferenceVoltage": diag.reference_voltage,
        "Temperature": diag.temperature,
        "Firmware": diag.firmware,
    }
    return Frame(state.frame_id, state.encode(signals))
