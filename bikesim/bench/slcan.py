"""A CAN adapter on a serial line (SLCAN, Lawicel's ASCII protocol), as a loop needs it.

python-can's own reads byte by byte, waits for whole milliseconds of the serial line, stops at the
adapter's answer to what was sent, and where the adapter takes nothing more it waits for ever.
"""

import contextlib
import os
import select
import threading
import time
from collections import deque
from typing import Any

import can
from can.interfaces.slcan import slcanBus

_END, _REFUSED = b"\r", b"\a"
_CHUNK = 4096  # bytes, at a read
_MOST_UNSENT = 256  # bytes, some ten frames


class SlcanBus(slcanBus):
    """As python-can's, but it waits no longer than it is told; many threads may use it.

    Frames with an 11-bit identifier; others are passed over, as the adapter's answers are. Sending
    and receiving raise CanOperationError or OSError where the adapter is gone or refuses a frame.
    """

    def __init__(self, channel: str, **arguments: Any) -> None:
        """As slcanBus."""
        super().__init__(channel, **arguments)
        self._file = self.serialPortOrig.fileno()
        os.set_blocking(self._file, False)
        self._begun = b""
        self._unsent = b""
        self._lines: deque[bytes] = deque()
        self._sending, self._receiving = threading.Lock(), threading.Lock()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Hands it to the system; what that does not take goes before the next."""
        del timeout
        with self._sending:
            data = self._unsent + _line(msg)
            with contextlib.suppress(BlockingIOError):
                data = data[os.write(self._file, data) :]
            self._unsent = data
        if len(data) > _MOST_UNSENT:
            raise can.CanOperationError("the adapter takes nothing more")

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        with self._receiving:
            return self._next(timeout), False

    def _next(self, timeout: float | None) -> can.Message | None:
        deadline = None if timeout is None else time.perf_counter() + timeout
        left, readable = timeout, False
        while True:
            if not self._lines and not self._take_what_came() and readable:
                # A line that has hung up is readable, without anything to read.
                raise can.CanOperationError("the adapter is gone")
            while self._lines:
                message = _message(self._lines.popleft())
                if message is not None:
                    return message
            if deadline is not None and (left := deadline - time.perf_counter()) <= 0:
                return None
            readable = bool(select.select([self._file], [], [], left)[0])

    def _take_what_came(self) -> bool:
        try:
            came = os.read(self._file, _CHUNK)
        except BlockingIOError:
            return False
        *lines, self._begun = (self._begun + came).replace(_REFUSED, _REFUSED + _END).split(_END)
        self._lines.extend(line for line in lines if line)
        return bool(came)

    def shutdown(self) -> None:
        """Closes channel and line; does not wait for an adapter that does not answer."""
        can.BusABC.shutdown(self)
        if not self.serialPortOrig.is_open:
            return
        with contextlib.suppress(OSError):
            if self._unsent:
                self.serialPortOrig.reset_output_buffer()
            os.write(self._file, b"C" + _END)
        self.serialPortOrig.close()

    def fileno(self) -> int:
        """Not to be polled: what came may have been read already."""
        raise NotImplementedError


def _line(message: can.Message) -> bytes:
    kind = "r" if message.is_remote_frame else "t"
    data = "" if message.is_remote_frame else message.data.hex().upper()
    return f"{kind}{message.arbitration_id:03X}{message.dlc}{data}\r".encode()


def _message(line: bytes) -> can.Message | None:
    """The frame that a line is; None for an answer, or what no adapter should say."""
    if line[-1:] == _REFUSED:
        raise can.CanOperationError("the adapter refused a frame: is the bus alive?")
    remote = line[:1] == b"r"
    if not remote and line[:1] != b"t":
        return None
    try:
        identifier, length = int(line[1:4], 16), int(line[4:5])
        data = b"" if remote else bytes.fromhex(line[5 : 5 + 2 * length].decode("ascii"))
    except ValueError:
        return None
    return can.Message(
        timestamp=time.time(),
        arbitration_id=identifier,
        is_extended_id=False,
        is_remote_frame=remote,
        dlc=length if remote else len(data),
        data=data,
    )
