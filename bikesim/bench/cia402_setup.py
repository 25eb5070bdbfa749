"""Sets a CiA 402 drive up over SDO, and sees that it took it. It is disabled before and after."""

import logging
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

from bikesim.bench.bus_errors import Unreadable, told
from bikesim.bench.cia402 import (
    CYCLIC_SYNCHRONOUS_TORQUE,
    DISABLE_VOLTAGE,
    FAULT_RESET,
    NmtCommand,
    NmtState,
    State,
    state_of,
)
from bikesim.bench.cia402_eds import check_fits, read_eds
from bikesim.bench.cia402_errors import error_told, found_in_fault
from bikesim.bench.cia402_objects import Write, set_up_writes
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.rated_torque import check_rated_torque
from bikesim.errors import InputError

if TYPE_CHECKING:
    import can
    import canopen
    from canopen.sdo.base import SdoVariable

_NO_SUCH_OBJECT = (0x06020000, 0x06090011)
_READ_ONLY = 0x06010002
_PATIENCE = 0.5  # s, for a state that must come by itself


class DriveReport(NamedTuple):
    """What was found: the drive's name, its rated torque [N m], objects it does not have.

    `fault`: in which one it was and that it was reset, in words; empty if it was in none.
    """

    name: str
    vendor_id: int
    product_code: int
    rated_torque: float
    missing: tuple[str, ...]
    fault: str = ""


def set_up(bus: "can.BusABC", drive: Cia402Settings) -> DriveReport:
    """Checks the drive against its profile, writes what the loop needs, reads it back, starts it.

    Until it returns it reads the bus alone, from a thread of its own: `bus` must bear that
    (`can.ThreadSafeBus`). Raises InputError; the drive was then not enabled.
    """
    import can
    from canopen import SdoAbortedError, SdoCommunicationError

    unreadable = Unreadable()
    try:
        with _node(bus, drive, unreadable) as node:
            return _SetUp(node, drive).run()
    except SdoCommunicationError:
        if unreadable.error is not None:
            raise InputError(f"the bus fails: {told(unreadable.error)}") from None
        raise InputError(f"{_who(drive)}: does not answer") from None
    except SdoAbortedError as error:
        raise InputError(f"{_who(drive)}: {error}") from None
    except (can.CanError, OSError) as error:
        raise InputError(f"the bus fails: {told(error)}") from None


@contextmanager
def _node(
    bus: "can.BusABC", drive: Cia402Settings, unreadable: Unreadable
) -> "Iterator[canopen.RemoteNode]":
    """The drive on a network that reads `bus`, and leaves it open."""
    import can
    import canopen

    # Else what it says of a time-out goes to the screen beside our own one line.
    logging.getLogger("canopen").addHandler(logging.NullHandler())
    dictionary = read_eds(drive)
    check_fits(dictionary, set_up_writes(drive), drive)
    network = canopen.Network(bus)
    network.notifier = can.Notifier(bus, [*network.listeners, unreadable], timeout=0.02)
    try:
        node = network.add_node(drive.node, dictionary)
        node.sdo.MAX_RETRIES = 2  # pyright: ignore[reportAttributeAccessIssue]
        yield node
    finally:
        network.notifier.stop()


def _who(drive: Cia402Settings) -> str:
    return f"drive {drive.node}"


class _SetUp:
    """One set-up; its methods are its steps."""

    def __init__(self, node: "canopen.RemoteNode", drive: Cia402Settings) -> None:
        self._node, self._drive = node, drive
        self._missing: list[str] = []
        self._state = NmtState.BOOT_UP
        # A callback: canopen's own waiting may miss what came between two calls.
        node.nmt.add_heartbeat_callback(self._heard)

    def run(self) -> DriveReport:
        self._node.nmt.send_command(NmtCommand.ENTER_PRE_OPERATIONAL)
        name, vendor, product = self._identity()
        self._check_mode()
        rated = check_rated_torque(
            self._read(0x6076), self._drive.torque_unit, self._drive.rated_torque
        )
        self._check_encoder()
        fault = self._disable()
        writes = set_up_writes(self._drive)
        for write in writes:
            self._write(write)
        self._verify(writes)
        self._start()
        return DriveReport(name, vendor, product, rated, tuple(self._missing), fault)

    # Checks

    def _identity(self) -> tuple[str, int, int]:
        profile = self._read(0x1000) & 0xFFFF
        if profile != 402:
            raise self._error(f"is no CiA 402 drive: its device profile (1000) is {profile}")
        vendor, product = self._read(0x1018, 1), self._read(0x1018, 2)
        self._must_be("vendor_id", vendor, self._drive.vendor_id)
        self._must_be("product_code", product, self._drive.product_code)
        return self._name(), vendor, product

    def _name(self) -> str:
        from canopen import SdoAbortedError

        try:
            return self._node.sdo.upload(0x1008, 0).decode("latin-1").strip("\0 ")
        except SdoAbortedError:
            return ""

    def _must_be(self, key: str, found: int, wanted: int | None) -> None:
        if wanted not in (None, found):
            raise self._error(f"has {key} {found:#x}, the profile {wanted:#x}")

    def _check_mode(self) -> None:
        if not self._read(0x6502) >> CYCLIC_SYNCHRONOUS_TORQUE - 1 & 1:
            raise self._error("has no cyclic synchronous torque mode (6502)")

    def _check_encoder(self) -> None:
        try:
            counts, turns = self._read(0x608F, 1), self._read(0x608F, 2)
        except _Absent:
            self._missing.append("608F (encoder resolution)")
            return
        if counts != self._drive.encoder_counts * turns:
            raise self._error(
                f"has {counts} encoder counts in {turns} turns (608F), "
                f"the profile {self._drive.encoder_counts} in one"
            )

    def _disable(self) -> str:
        """To switch on disabled; a fault that is left from before is reset once, and told."""
        controlword = self._variable(0x6040, 0)
        controlword.raw = DISABLE_VOLTAGE
        fault = ""
        if state_of(self._read(0x6041)) is State.FAULT:
            fault = found_in_fault(self._read(0x603F))
            controlword.raw = FAULT_RESET
        deadline = time.monotonic() + _PATIENCE
        while (state := state_of(self._read(0x6041))) is not State.SWITCH_ON_DISABLED:
            if time.monotonic() > deadline:
                error = error_told(self._read(0x603F))
                raise self._error(f"stays in {state.told}, error {error}")
            time.sleep(0.01)
        return fault

    # Writing and reading

    def _read(self, index: int, subindex: int = 0) -> int:
        from canopen import ObjectDictionaryError, SdoAbortedError

        where = f"{index:04X}:{subindex:02X}"
        try:
            value = self._variable(index, subindex).raw
        except ObjectDictionaryError:
            raise self._error(f"has {where} in another length than {self._drive.eds}") from None
        except SdoAbortedError as error:
            if error.code in _NO_SUCH_OBJECT:
                raise _Absent(f"{_who(self._drive)}: has no {where}") from None
            raise
        if not isinstance(value, int):
            raise self._error(f"{self._drive.eds} has no number as {where}")
        return value

    def _variable(self, index: int, subindex: int) -> "SdoVariable":
        found = self._node.sdo.get_variable(index, subindex)
        # Without subindices, an object is found under any.
        if found is None or found.subindex != subindex:
            where = f"{index:04X}:{subindex:02X}"
            raise _Absent(f"{_who(self._drive)}: {self._drive.eds} has no {where}")
        return found

    def _write(self, write: Write) -> None:
        from canopen import SdoAbortedError

        try:
            self._variable(write.index, write.subindex).raw = write.value
        except _Absent:
            if not write.optional:
                raise
        except SdoAbortedError as error:
            # What cannot be written may still be as it should: that is seen when it is read.
            if not write.optional or error.code not in (*_NO_SUCH_OBJECT, _READ_ONLY):
                raise self._error(f"refused {write.name} = {write.value}: {error}") from None

    def _verify(self, writes: Iterable[Write]) -> None:
        last = {(write.index, write.subindex): write for write in writes}
        for write in last.values():
            try:
                found = self._read(write.index, write.subindex)
            except _Absent:
                if not write.optional:
                    raise
                self._missing.append(write.name)
                continue
            if (found ^ write.value) & write.mask:
                raise self._error(f"has {write.name} = {found} after {write.value} was written")

    def _start(self) -> None:
        self._node.nmt.send_command(NmtCommand.START)
        deadline = time.monotonic() + _PATIENCE + 2 * self._drive.heartbeat_period
        while self._state is not NmtState.OPERATIONAL:
            if time.monotonic() > deadline:
                raise self._error("does not become operational, or sends no heartbeat")
            time.sleep(0.002)

    def _heard(self, state: int) -> None:
        if state in [*NmtState]:
            self._state = NmtState(state)

    def _error(self, what: str) -> InputError:
        return InputError(f"{_who(self._drive)}: {what}")


class _Absent(InputError):
    """The drive, or its EDS, does not have an object."""
