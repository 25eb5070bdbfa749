"""The messages of our own sensor nodes, as `hardware/can/steer_node.dbc` defines them."""

from functools import cache
from typing import TYPE_CHECKING

from bikesim.bench.crc import FrameCrc
from bikesim.data import data_path

if TYPE_CHECKING:
    from cantools.database.can import Database, Message

STEER_STATE = "SteerState"
STEER_DIAG = "SteerDiag"
STEER_COMMAND = "SteerCommand"
STEER_REPLY = "SteerReply"
WHEEL_SPEED = "WheelSpeed"


@cache
def sensor_database() -> "Database":
    """The database, read once."""
    import cantools

    database = cantools.database.load_file(data_path("hardware", "can", "steer_node.dbc"))
    assert isinstance(database, cantools.database.Database)
    return database


def message(name: str) -> "Message":
    """A message by its name."""
    return sensor_database().get_message_by_name(name)


def frame_crc(message: "Message") -> FrameCrc:
    """The CRC over a message's frames, with the data id that the database has for it."""
    return FrameCrc(_attribute(message, "DataId"))


def cycle_time(message: "Message") -> float:
    """Time between two frames of a message [s]."""
    return _attribute(message, "GenMsgCycleTime") / 1000


def scale(message: "Message", signal: str) -> float:
    """What a count of a signal is in its unit."""
    return float(message.get_signal_by_name(signal).scale)


def decoded(message: "Message", data: bytes) -> dict[str, float]:
    """A frame's signals by name, in their units, as cantools decodes them."""
    signals = message.decode_simple(data, decode_choices=False)
    return {name: v for name, v in signals.items() if isinstance(v, int | float)}


def _attribute(message: "Message", name: str) -> int:
    assert message.dbc is not None
    return int(message.dbc.attributes[name].value)
