"""A CAN frame between our parts, and python-can's message at the edge."""

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import can


class Frame(NamedTuple):
    """A classic CAN frame with an 11-bit identifier; `remote`: a request without data."""

    id: int
    data: bytes = b""
    remote: bool = False


def to_message(frame: Frame) -> "can.Message":
    """For python-can to send."""
    import can

    return can.Message(
        arbitration_id=frame.id,
        data=frame.data,
        is_remote_frame=frame.remote,
        is_extended_id=False,
        dlc=8 if frame.remote else None,
    )


def from_message(message: "can.Message") -> Frame | None:
    """What python-can received; None for an error frame or one of another format."""
    if message.is_error_frame or message.is_extended_id or message.is_fd:
        return None
    return Frame(message.arbitration_id, bytes(message.data), message.is_remote_frame)
