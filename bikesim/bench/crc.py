"""CRC-8 SAE J1850, with which the sensor nodes protect their frames."""

_POLYNOMIAL = 0x1D
_INITIAL = _FINAL_XOR = 0xFF


def _shifted(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1 ^ _POLYNOMIAL) & 0xFF if byte & 0x80 else byte << 1
    return byte


_TABLE = tuple(_shifted(byte) for byte in range(256))


def crc8(data: bytes) -> int:
    """The CRC of any bytes; of b"123456789" it is 0x4B."""
    crc = _INITIAL
    for byte in data:
        crc = _TABLE[crc ^ byte]
    return crc ^ _FINAL_XOR


class FrameCrc:
    """The CRC of an 8-byte frame: over the message's data id, then bytes 1 to 7.

    The data id, which is not sent, tells a frame from another one with the same content.
    """

    def __init__(self, data_id: int) -> None:
        self._after_id = _TABLE[_INITIAL ^ data_id]

    def __call__(self, data: bytes) -> int:
        """Of the frame, whatever its byte 0 is."""
        # Without a loop: this is done for each frame of a tick.
        table = _TABLE
        _, a, b, c, d, e, f, g = data
        crc = table[table[table[self._after_id ^ a] ^ b] ^ c]
        return table[table[table[table[crc ^ d] ^ e] ^ f] ^ g] ^ _FINAL_XOR

    def seal(self, data: bytes) -> bytes:
        """The frame with its CRC in byte 0."""
        return bytes((self(data),)) + data[1:]
