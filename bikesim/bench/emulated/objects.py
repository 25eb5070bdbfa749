"""The object dictionary of an emulated CANopen device, made from an EDS."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canopen.objectdictionary import ODVariable

NO_SUCH_OBJECT = 0x06020000
NO_SUCH_SUBINDEX = 0x06090011
READ_ONLY = 0x06010002
NOT_MAPPABLE = 0x06040041
PDO_TOO_LONG = 0x06040042
WRONG_LENGTH = 0x06070010
NOT_NOW = 0x08000022  # because of the present state of the device

Check = Callable[[int, int, int], None]


class SdoAbort(Exception):
    """An access that is refused, with the code that tells why."""

    def __init__(self, code: int) -> None:
        super().__init__(f"{code:#010x}")
        self.code = code


class Objects:
    """Values of objects by index and subindex; whole numbers, or text where the EDS has it."""

    def __init__(self, eds: Path, node: int) -> None:
        import canopen
        from canopen.objectdictionary import ODVariable

        self._variables: dict[tuple[int, int], ODVariable] = {}
        for entry in canopen.import_od(str(eds), node).values():
            members = [entry] if isinstance(entry, ODVariable) else entry.values()
            self._variables |= {(one.index, one.subindex): one for one in members}
        self._values = {
            key: 0 if one.default is None else one.default for key, one in self._variables.items()
        }

    def __contains__(self, key: tuple[int, int]) -> bool:
        return key in self._variables

    def get(self, index: int, subindex: int = 0, missing: int = 0) -> int:
        """A number; `missing` where there is no such object."""
        value = self._values.get((index, subindex), missing)
        assert isinstance(value, int)
        return value

    def set(self, index: int, subindex: int, value: int) -> None:
        """Sets a number, as the device itself may."""
        self._values[index, subindex] = value

    def remove(self, index: int) -> None:
        """Makes a device that does not have an object."""
        for key in [key for key in self._variables if key[0] == index]:
            del self._variables[key], self._values[key]

    def mappable_bits(self, index: int, subindex: int) -> int:
        """How long an object is in a PDO. Raises SdoAbort if it cannot be in one."""
        variable = self._variable(index, subindex)
        if not variable.pdo_mappable:
            raise SdoAbort(NOT_MAPPABLE)
        return len(variable)

    def upload(self, index: int, subindex: int) -> bytes:
        """What a client reads. Raises SdoAbort."""
        variable = self._variable(index, subindex)
        return variable.encode_raw(self._values[index, subindex])

    def download(self, index: int, subindex: int, data: bytes, check: Check) -> int:
        """What a client writes; `check` may raise SdoAbort. Gives the number."""
        variable = self._variable(index, subindex)
        if not variable.writable:
            raise SdoAbort(READ_ONLY)
        if len(data) * 8 != len(variable):
            raise SdoAbort(WRONG_LENGTH)
        value = variable.decode_raw(data)
        assert isinstance(value, int)
        check(index, subindex, value)
        self._values[index, subindex] = value
        return value

    def decode(self, index: int, subindex: int, data: bytes) -> int:
        """A number out of a PDO."""
        value = self._variable(index, subindex).decode_raw(data)
        assert isinstance(value, int)
        return value

    def _variable(self, index: int, subindex: int) -> "ODVariable":
        if (index, subindex) in self._variables:
            return self._variables[index, subindex]
        known = any(key[0] == index for key in self._variables)
        raise SdoAbort(NO_SUCH_SUBINDEX if known else NO_SUCH_OBJECT)
