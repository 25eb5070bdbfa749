"""What the cyclic messages of our sensor nodes have in common: CRC, status and counter, time.

Byte 0 is the CRC, the low half of byte 1 the counter, its high half four status bits; the last two
are the sample time. What lies between is the message's own.
"""

import struct

from bikesim.bench.continuity import (
    COUNTS,
    TIME_UNIT,
    BadFrame,
    Continuity,
    Flaw,
    Passage,
)
from bikesim.bench.database import cycle_time, frame_crc, message, scale
from bikesim.bench.frame import Frame


class SealedMessage:
    """One message of one node, by its name in the database; `layout` of what is its own."""

    def __init__(self, name: str, layout: str) -> None:
        self._message = message(name)
        self.id = self._message.frame_id
        self._crc = frame_crc(self._message)
        self._layout = struct.Struct(f"<BB{layout}H")

    def scale(self, signal: str) -> float:
        """What a count of a signal is in its unit."""
        return scale(self._message, signal)


class SealedFrames(SealedMessage):
    """Opens a message's frames, in the order in which they came."""

    def __init__(self, name: str, layout: str) -> None:
        super().__init__(name, layout)
        self._continuity = Continuity(cycle_time(self._message))

    def opened(self, data: bytes, arrival: float) -> tuple[tuple[int, ...], Passage] | BadFrame:
        """All fields as they stand, the second with its status bits; when it came [s], the host's
        clock. Raises nothing.
        """
        if len(data) != 8:
            return BadFrame(Flaw.LENGTH)
        fields = self._layout.unpack(data)
        if fields[0] != self._crc(data):
            return BadFrame(Flaw.CRC)
        passage = self._continuity.follow(fields[1] & 0x0F, fields[-1], arrival)
        return BadFrame(passage) if isinstance(passage, Flaw) else (fields, passage)


class SealingFrames(SealedMessage):
    """Makes a message's frames, as the node does: counts and seals."""

    def __init__(self, name: str, layout: str) -> None:
        super().__init__(name, layout)
        self._counter = 0

    def sealed(self, status: int, time: float, *own: int) -> Frame:
        """The next frame; status bits, time [s] on the node's clock, its own fields."""
        bits = status | self._counter
        self._counter = (self._counter + 1) % COUNTS
        data = self._layout.pack(0, bits, *own, round(time / TIME_UNIT) & 0xFFFF)
        return Frame(self.id, self._crc.seal(data))


def saturated(count: float) -> int:
    """To the nearest count that 16 bits hold, the same to both sides."""
    return max(-32767, min(32767, round(count)))
