"""What a bench writes into a CiA 402 drive before it is used, object by object, in order."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from bikesim.bench.cia402 import CYCLIC_SYNCHRONOUS_TORQUE, DISABLE_VOLTAGE
from bikesim.bench.cia402_frames import SYNC, CobIds
from bikesim.bench.cia402_settings import Cia402Settings

_NOT_VALID = 0x80000000  # bit of a COB-ID: the PDO is not there
_COB_ID_MASK = _NOT_VALID | 0x7FF  # of the rest, drives set what they like
_ON_EACH_SYNC, _AT_ONCE = 1, 255  # transmission types

_CONTROLWORD, _TARGET_TORQUE, _MODE = 0x60400010, 0x60710010, 0x60600008
_STATUSWORD, _TORQUE, _POSITION = 0x60410010, 0x60770010, 0x60640020
_VELOCITY, _MODE_DISPLAY, _ERROR = 0x606C0020, 0x60610008, 0x603F0010


@dataclass(frozen=True, slots=True)
class Write:
    """An object's value, and why. `optional`: not every drive has it.

    Reading it back, when all is written, must give `value` in the bits of `mask`.
    """

    index: int
    subindex: int
    value: int
    why: str
    optional: bool = False
    mask: int = 0xFFFFFFFF

    @property
    def name(self) -> str:
        """As the manuals write it."""
        return f"{self.index:04X}:{self.subindex:02X} ({self.why})"


def set_up_writes(drive: Cia402Settings) -> tuple[Write, ...]:
    """All of them; the order matters."""
    return (
        *_own_writes(drive),
        *(Write(o.index, o.subindex, o.value, "from the profile") for o in drive.objects),
    )


_CHECKED = {(0x6076, 0): "rated torque", (0x608F, 1): "encoder", (0x608F, 2): "encoder"}


def doubly_written(drive: Cia402Settings) -> str:
    """What of its `objects` would undo the set-up or what it checked, in words; else empty."""
    taken = {(one.index, one.subindex): one.why for one in _own_writes(drive)} | _CHECKED
    for one in drive.objects:
        if why := taken.get((one.index, one.subindex)):
            return (
                f"objects: {one.index:04X}:{one.subindex:02X} ({why}) is the set-up's own, "
                "by the profile's other keys; leave it out"
            )
    return ""


def _own_writes(drive: Cia402Settings) -> tuple[Write, ...]:
    return (
        *_standstill(),
        *_supervision(drive),
        *_limits(drive),
        Write(0x6060, 0, CYCLIC_SYNCHRONOUS_TORQUE, "mode of operation"),
        *_pdos(drive),
    )


def _standstill() -> Iterator[Write]:
    yield Write(0x6040, 0, DISABLE_VOLTAGE, "controlword")
    yield Write(0x6071, 0, 0, "target torque")
    # Added to the target: one that is stored in the drive would act as soon as it is enabled.
    yield Write(0x60B2, 0, 0, "torque offset", optional=True)


def _supervision(drive: Cia402Settings) -> Iterator[Write]:
    timeout, period = _ms(drive.heartbeat_timeout), _ms(drive.heartbeat_period)
    yield Write(0x1005, 0, SYNC.id, "SYNC", optional=True, mask=_COB_ID_MASK)
    yield Write(0x1014, 0, 0x80 + drive.node, "EMCY", optional=True, mask=_COB_ID_MASK)
    yield Write(0x1016, 1, drive.host_node << 16 | timeout, "heartbeat of the host")
    yield Write(0x1017, 0, period, "heartbeat of the drive")
    # The drive stays operational and goes on telling that it is in fault.
    yield Write(0x1029, 1, 1, "NMT state after a lost heartbeat", optional=True)
    yield Write(0x6007, 0, 1, "lost connection: fault", optional=True)
    yield Write(0x605E, 0, 0, "fault: motor free", optional=True)
    yield Write(0x605A, 0, 0, "quick stop: motor free", optional=True)


def _limits(drive: Cia402Settings) -> Iterator[Write]:
    yield Write(0x6072, 0, drive.scale.torque_limit, "largest torque")
    yield Write(0x6080, 0, motor_speed_limit(drive), "largest motor speed")


def motor_speed_limit(drive: Cia402Settings) -> int:
    """The speed limit as object 6080 has it: rpm of the motor."""
    return max(1, math.floor(drive.speed_limit * drive.gear * 60 / (2 * math.pi)))


def _pdos(drive: Cia402Settings) -> Iterator[Write]:
    ids = CobIds.of_node(drive.node)
    for number in (1, 2, 3):
        yield from _absent(0x1400 + number, 0x200 + 0x100 * number + drive.node, "RPDO")
    for number in (2, 3):
        yield from _absent(0x1800 + number, 0x180 + 0x100 * number + drive.node, "TPDO")
    commands = (_CONTROLWORD, _TARGET_TORQUE, _MODE)
    yield from _pdo(0x1400, ids.command, _AT_ONCE, commands, "RPDO1")
    yield from _pdo(0x1800, ids.status, _ON_EACH_SYNC, (_STATUSWORD, _TORQUE, _POSITION), "TPDO1")
    yield from _pdo(0x1801, ids.motion, _ON_EACH_SYNC, (_VELOCITY, _MODE_DISPLAY, _ERROR), "TPDO2")


def _absent(index: int, cob_id: int, name: str) -> Iterator[Write]:
    """A PDO that a drive may have and nobody wants: it would load the bus."""
    why = f"{name}{(index & 0xFF) + 1} off"
    yield Write(index, 1, _NOT_VALID | cob_id, why, optional=True, mask=_NOT_VALID)


def _pdo(
    index: int, cob_id: int, transmission: int, mapped: Iterable[int], name: str
) -> Iterator[Write]:
    """Its mapping may be changed only while it is not valid and maps nothing."""
    mapping, entries = index + 0x200, tuple(mapped)
    yield Write(index, 1, _NOT_VALID | cob_id, f"{name} off", mask=_COB_ID_MASK)
    yield Write(index, 2, transmission, f"{name} transmission type")
    yield Write(mapping, 0, 0, f"{name} maps nothing")
    for number, entry in enumerate(entries, start=1):
        yield Write(mapping, number, entry, f"{name} mapping")
    yield Write(mapping, 0, len(entries), f"{name} mapping")
    yield Write(index, 1, cob_id, f"{name} on", mask=_COB_ID_MASK)


def _ms(seconds: float) -> int:
    return round(seconds * 1000)
