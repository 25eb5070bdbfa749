"""An SDO server (CiA 301): expedited reading and writing, and segmented reading of longer text."""

import struct
from collections.abc import Callable

from bikesim.bench.emulated.objects import Objects, SdoAbort

_HEADER = struct.Struct("<BHB")
_ABORT = struct.Struct("<BHBI")
_TOGGLE_WRONG, _UNKNOWN_COMMAND, _TOO_LONG = 0x05030000, 0x05040001, 0x06070012
_ABORTED, _DOWNLOAD, _UPLOAD, _UPLOAD_SEGMENT = 4, 1, 2, 3  # upper three bits of a command
_TOGGLE = 0x10


class SdoServer:
    """Answers one client. `written` is told of each number that was written."""

    def __init__(
        self,
        objects: Objects,
        check: Callable[[int, int, int], None],
        written: Callable[[int, int, int], None],
    ) -> None:
        """`check(index, subindex, value)` raises SdoAbort for what must not be written now."""
        self._objects, self._check, self._written = objects, check, written
        self._rest = b""
        self._toggle = 0

    def answer(self, request: bytes) -> bytes | None:
        """The response to a request of 8 bytes; None to an abort, and to what is no request."""
        if len(request) != 8 or request[0] >> 5 == _ABORTED:
            return None
        _, index, subindex = _HEADER.unpack_from(request)
        try:
            return self._answer(request[0], index, subindex, request)
        except SdoAbort as abort:
            return _ABORT.pack(0x80, index, subindex, abort.code)

    def _answer(self, command: int, index: int, subindex: int, request: bytes) -> bytes:
        kind = command >> 5
        if kind == _DOWNLOAD:
            return self._download(command, index, subindex, request[4:])
        if kind == _UPLOAD:
            return self._upload(index, subindex)
        if kind == _UPLOAD_SEGMENT:
            return self._upload_segment(command)
        raise SdoAbort(_UNKNOWN_COMMAND)

    def _download(self, command: int, index: int, subindex: int, data: bytes) -> bytes:
        if not command & 0x02:
            raise SdoAbort(_TOO_LONG)
        size = 4 - (command >> 2 & 3) if command & 0x01 else 4
        value = self._objects.download(index, subindex, data[:size], self._check)
        self._written(index, subindex, value)
        return _HEADER.pack(0x60, index, subindex) + bytes(4)

    def _upload(self, index: int, subindex: int) -> bytes:
        data = self._objects.upload(index, subindex)
        if len(data) <= 4:
            command = 0x43 | 4 - len(data) << 2
            return _HEADER.pack(command, index, subindex) + data.ljust(4, b"\0")
        self._rest, self._toggle = data, 0
        return _HEADER.pack(0x41, index, subindex) + struct.pack("<I", len(data))

    def _upload_segment(self, command: int) -> bytes:
        if command & _TOGGLE != self._toggle:
            raise SdoAbort(_TOGGLE_WRONG)
        segment, self._rest = self._rest[:7], self._rest[7:]
        first = self._toggle | 7 - len(segment) << 1 | (0 if self._rest else 1)
        self._toggle ^= _TOGGLE
        return bytes((first,)) + segment.ljust(7, b"\0")
