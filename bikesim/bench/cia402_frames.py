"""The frames between host and CiA 402 drive while the loop runs: PDOs, heartbeats, emergencies.

Little-endian. The layout of the PDOs is what `cia402_setup` writes into the drive.
"""

import struct
from typing import NamedTuple

from bikesim.bench.cia402 import NmtCommand, NmtState
from bikesim.bench.frame import Frame

NMT = 0x000
SYNC = Frame(0x080)

_COMMAND = struct.Struct("<Hhb")  # 6040, 6071, 6060
_STATUS = struct.Struct("<Hhi")  # 6041, 6077, 6064
_MOTION = struct.Struct("<ibH")  # 606C, 6061, 603F
_EMERGENCY = struct.Struct("<HB5s")


class CobIds(NamedTuple):
    """The identifiers of a drive's frames, as CiA 301 gives them to its node."""

    emergency: int
    status: int  # TPDO1
    command: int  # RPDO1
    motion: int  # TPDO2
    sdo_answer: int
    sdo_request: int
    heartbeat: int

    @classmethod
    def of_node(cls, node: int) -> "CobIds":
        """For a node of 1 to 127."""
        bases = (0x080, 0x180, 0x200, 0x280, 0x580, 0x600, 0x700)
        return cls(*(base + node for base in bases))

    @property
    def from_drive(self) -> tuple[int, ...]:
        """What the drive sends."""
        return self.emergency, self.status, self.motion, self.sdo_answer, self.heartbeat

    def to_drive(self, host_node: int) -> tuple[int, ...]:
        """What the host sends, its own heartbeat among it."""
        return NMT, SYNC.id, self.command, self.sdo_request, 0x700 + host_node


class DriveCommand(NamedTuple):
    """RPDO1: controlword, torque in per mille of the rated torque, mode."""

    controlword: int
    torque: int
    mode: int


class DriveStatus(NamedTuple):
    """TPDO1: statusword, actual torque in per mille of the rated torque, position in counts."""

    statusword: int
    torque: int
    position: int


class DriveMotion(NamedTuple):
    """TPDO2: velocity in the drive's unit, mode display, error code of the last fault."""

    velocity: int
    mode: int
    error: int


class Emergency(NamedTuple):
    """EMCY: error code (0: no error any more), error register (1001), five bytes of the maker."""

    error: int
    register: int
    detail: bytes


def pack_command(command: DriveCommand) -> bytes:
    """RPDO1."""
    return _COMMAND.pack(*command)


def unpack_status(data: bytes) -> DriveStatus | None:
    """TPDO1; None if it is not what was mapped."""
    return DriveStatus._make(_STATUS.unpack(data)) if len(data) == _STATUS.size else None


def unpack_motion(data: bytes) -> DriveMotion | None:
    """TPDO2; None if it is not what was mapped."""
    return DriveMotion._make(_MOTION.unpack(data)) if len(data) == _MOTION.size else None


def unpack_emergency(data: bytes) -> Emergency | None:
    """EMCY; None if it is none."""
    return Emergency._make(_EMERGENCY.unpack(data)) if len(data) == _EMERGENCY.size else None


def unpack_heartbeat(data: bytes) -> NmtState | None:
    """A node's state; None if it is none."""
    try:
        return NmtState(data[0] & 0x7F) if len(data) == 1 else None
    except ValueError:
        return None


def heartbeat(node: int, state: NmtState = NmtState.OPERATIONAL) -> Frame:
    """A node's heartbeat; the host has one too."""
    return Frame(0x700 + node, bytes((state,)))


def nmt(command: NmtCommand, node: int) -> Frame:
    """The master's command to a node; node 0: to all."""
    return Frame(NMT, bytes((command, node)))
