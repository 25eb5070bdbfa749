"""The PDOs of an emulated CANopen device, as its objects say at the moment."""

from collections.abc import Iterator

from bikesim.bench.emulated.objects import NOT_NOW, PDO_TOO_LONG, Objects, SdoAbort

_NOT_VALID = 0x80000000
_RECEIVE, _TRANSMIT = 0x1400, 0x1800
_MAPPING = 0x200  # from a PDO's parameters to what it maps
_SYNCHRONOUS = 240  # the last of the transmission types that go with SYNC
_COUNT = 4


class Pdos:
    """Takes PDOs apart and makes them, by the mapping that is set."""

    def __init__(self, objects: Objects) -> None:
        self._objects = objects

    def receive(self, cob_id: int, data: bytes) -> dict[tuple[int, int], int] | None:
        """What a frame sets, by index and subindex; None if it is too short for its mapping."""
        for index in self._present(_RECEIVE):
            if self._objects.get(index, 1) & 0x7FF == cob_id:
                return self._taken_apart(index, data)
        return {}

    def on_sync(self) -> Iterator[tuple[int, bytes]]:
        """The frames that go out with a SYNC."""
        for index in self._present(_TRANSMIT):
            if 1 <= self._objects.get(index, 2) <= _SYNCHRONOUS:
                data = b"".join(self._objects.upload(i, s) for i, s, _ in self._mapped(index))
                yield self._objects.get(index, 1) & 0x7FF, data

    def check(self, index: int, subindex: int, value: int) -> None:
        """Raises SdoAbort for what CiA 301 does not allow while a PDO is in use."""
        for first in (_RECEIVE, _TRANSMIT):
            if index in range(first, first + _COUNT) and subindex == 1:
                self._check_cob_id(index, value)
            if index in range(first + _MAPPING, first + _MAPPING + _COUNT):
                self._check_mapping(index - _MAPPING, subindex, value)

    def _check_cob_id(self, index: int, value: int) -> None:
        now = self._objects.get(index, 1)
        if not (now | value) & _NOT_VALID and now != value:
            raise SdoAbort(NOT_NOW)

    def _check_mapping(self, index: int, subindex: int, value: int) -> None:
        mapping = index + _MAPPING
        if not self._objects.get(index, 1) & _NOT_VALID:
            raise SdoAbort(NOT_NOW)
        if subindex == 0:
            entries = (self._objects.get(mapping, number + 1) for number in range(value))
            if sum(entry & 0xFF for entry in entries) > 64:
                raise SdoAbort(PDO_TOO_LONG)
        elif self._objects.get(mapping, 0):
            raise SdoAbort(NOT_NOW)
        elif self._objects.mappable_bits(value >> 16, value >> 8 & 0xFF) != value & 0xFF:
            raise SdoAbort(PDO_TOO_LONG)

    def _present(self, first: int) -> Iterator[int]:
        for index in range(first, first + _COUNT):
            if (index, 1) in self._objects and not self._objects.get(index, 1) & _NOT_VALID:
                yield index

    def _mapped(self, index: int) -> Iterator[tuple[int, int, int]]:
        """Index, subindex and length in bytes of each object in a PDO."""
        for number in range(self._objects.get(index + _MAPPING, 0)):
            entry = self._objects.get(index + _MAPPING, number + 1)
            yield entry >> 16, entry >> 8 & 0xFF, (entry & 0xFF) // 8

    def _taken_apart(self, index: int, data: bytes) -> dict[tuple[int, int], int] | None:
        taken, at = {}, 0
        for i, s, size in self._mapped(index):
            if at + size > len(data):
                return None
            taken[i, s] = self._objects.decode(i, s, data[at : at + size])
            at += size
        return taken
