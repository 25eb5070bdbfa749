"""Calibrated nodes, and what they say."""

import struct
import zlib
from collections.abc import Callable

from cantools.database.can import Database

from bikesim.bench.calibration import NodeCalibration

from .binding import Firmware

PowerUp = Callable[..., Firmware]
CALIBRATION = NodeCalibration(0.45, -5.76, 0.51, 10.47, 3.3)


def block(calibration: NodeCalibration = CALIBRATION, version: int = 1) -> bytes:
    """What the memory of a calibrated node has, as calibration.h says."""
    data = struct.pack("<4sHH5i", b"BCAL", version, 20, *calibration.counts())
    return data + struct.pack("<I", zlib.crc32(data))


def state(database: Database, node: Firmware) -> dict:
    """What the next SteerState says, by cantools."""
    frames = dict(node.cycle())
    return dict(database.get_message_by_name("SteerState").decode_simple(frames[0x110]))
