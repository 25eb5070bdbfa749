"""The structures of the firmware, and its cycle, by ctypes."""

from ctypes import (
    CDLL,
    POINTER,
    Structure,
    byref,
    c_bool,
    c_int8,
    c_int32,
    c_ubyte,
    c_uint8,
    c_uint16,
    c_uint32,
    memmove,
    sizeof,
)

BLOCK = 32
SENT = 64


class CFrame(Structure):
    _fields_ = [("id", c_uint16), ("length", c_uint8), ("data", c_uint8 * 8)]


class CSample(Structure):
    _fields_ = [
        ("pot", c_uint16), ("reference", c_uint16), ("gyro", c_uint16), ("supply_mv", c_uint16),
        ("temperature", c_int8), ("estop_closed", c_bool), ("time", c_uint32),
    ]  # fmt: skip


class CHostBoard(Structure):
    _fields_ = [
        ("sample", CSample), ("sent", CFrame * SENT), ("sent_count", c_uint32),
        ("received", CFrame), ("has_received", c_bool), ("memory_fails", c_bool),
        ("memory", c_ubyte * BLOCK), ("waits", c_uint32), ("feeds", c_uint32),
    ]  # fmt: skip


class CNode(Structure):
    _fields_ = [
        ("acting", c_int32 * 5), ("pending", c_int32 * 5), ("calibrated", c_bool),
        ("estop_closed", c_bool), ("counter", c_uint8), ("until_diag", c_uint8),
    ]  # fmt: skip


class Firmware:
    """A node that has just got power. `sample` is what its board will sample."""

    def __init__(self, library: CDLL, memory: bytes) -> None:
        self._library = library
        library.crc8.restype = c_uint8
        library.crc32.restype = c_uint32
        library.cycle.argtypes = library.cycle_start.argtypes = [POINTER(CNode)]
        self.board = CHostBoard.in_dll(library, "host_board")
        self.sample = self.board.sample
        memmove(self.board.memory, memory, BLOCK)
        self.board.memory_fails = False
        self.sample.pot = self.sample.gyro = 32768
        self.sample.reference, self.sample.supply_mv = 65535, 3300
        self.sample.temperature, self.sample.time = 25, 0
        self.sample.estop_closed = True
        # Longer than it is there: had the structures changed, this would be seen.
        self._node = (CNode * 2)()
        self._take = 0
        library.cycle_start(self._node[0])

    @property
    def memory(self) -> bytes:
        return bytes(self.board.memory)

    def cycle(self) -> list[tuple[int, bytes]]:
        """One millisecond; identifiers and data of the frames that it sent."""
        self._library.cycle(byref(self._node[0]))
        assert bytes(self._node[1]) == bytes(sizeof(CNode))
        count = self.board.sent_count
        frames = [self.board.sent[n % SENT] for n in range(self._take, count)]
        self._take = count
        return [(f.id, bytes(f.data[: f.length])) for f in frames]

    def command(self, identifier: int, data: bytes) -> list[bytes]:
        """A cycle in which a frame is received; the answers to it."""
        received = self.board.received
        received.id, received.length = identifier, len(data)
        memmove(received.data, data.ljust(8, b"\0"), 8)
        self.board.has_received = True
        return [data for sent, data in self.cycle() if sent == 0x113]

    def crc8(self, data: bytes) -> int:
        return self._library.crc8(data, len(data))

    def crc32(self, data: bytes) -> int:
        return self._library.crc32(data, len(data))
