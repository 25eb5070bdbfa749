"""An emulated CiA 402 drive in cyclic synchronous torque mode, as a pure state machine."""

import struct
from collections.abc import Iterable

from bikesim.bench.cia402 import (
    CYCLIC_SYNCHRONOUS_TORQUE,
    HEARTBEAT_LOST,
    NmtCommand,
    NmtState,
    State,
)
from bikesim.bench.cia402_frames import (
    NMT,
    SYNC,
    CobIds,
    DriveCommand,
    heartbeat,
    pack_command,
)
from bikesim.bench.emulated.device import Periodic
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.emulated.objects import Objects
from bikesim.bench.emulated.pdos import Pdos
from bikesim.bench.emulated.power_stage import PowerStage
from bikesim.bench.emulated.sdo_server import SdoServer
from bikesim.bench.frame import Frame
from bikesim.data import data_path

_PDO_TOO_SHORT, _SHORT_CIRCUIT = 0x8210, 0x2310  # emergency error codes
_ENABLED = 0x0F  # controlword
_NMT_STATES = {
    NmtCommand.START: NmtState.OPERATIONAL,
    NmtCommand.STOP: NmtState.STOPPED,
    NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
}


class EmulatedDrive:
    """Out of its box: what the set-up does not write is as a maker leaves it.

    `angle` [rad] and `rate` [rad/s] of its shaft are set from outside; `torque` is what it gives.
    A heartbeat of the host that stops is a fault only where object 6007 says so; else the last
    torque acts on, as some real drives let it. `strength`: what share of the torque that it is told
    its motor gives; `offset` [N m]: what it measures beside that.
    """

    def __init__(self, node: int, motor: Motor, *, without: Iterable[int] = ()) -> None:
        """`without`: indices of objects that this maker's drive does not have."""
        self.node, self.motor = node, motor
        self.angle = self.rate = 0.0
        self.strength, self.offset = 1.0, 0.0
        self._stuck_mode: int | None = None
        self._without = tuple(without)
        self._power_up()

    def _power_up(self) -> None:
        self.objects = Objects(data_path("hardware", "can", "cia402_drive.eds"), self.node)
        for index in self._without:
            self.objects.remove(index)
        self.objects.set(0x6076, 0, self.motor.rated_torque_object)
        self.objects.set(0x608F, 1, self.motor.encoder_counts)
        self._pdos = Pdos(self.objects)
        self._sdo = SdoServer(self.objects, self._pdos.check, self._written)
        self._power = PowerStage()
        self.nmt = NmtState.BOOT_UP
        self._heartbeat = Periodic(0.0)
        self._host_heard: float | None = None
        self._outbox: list[Frame] = []

    @property
    def state(self) -> State:
        """Of the power stage."""
        return self._power.state

    @property
    def torque(self) -> float:
        """What acts on the shaft [N m]."""
        return self.strength * self.motor.torque(self._acting())

    def fail(self, error: int, time: float, *, remains: bool = False) -> None:
        """A fault of its own, by its emergency error code; `remains`: it cannot be reset."""
        self._power.cause_remains = remains
        self._power.fail(time)
        self.objects.set(0x603F, 0, error)
        self._emergency(error)

    def disable(self) -> None:
        """By itself, without an error: somebody pressed a button on it."""
        self._power.disable()

    def break_down(self) -> None:
        """A short circuit: continuous over current."""
        self.fail(_SHORT_CIRCUIT, 0.0)

    def command_of_another(self) -> Frame:
        """See `DriveDevice`."""
        command = DriveCommand(_ENABLED, 0, CYCLIC_SYNCHRONOUS_TORQUE)
        return Frame(CobIds.of_node(self.node).command, pack_command(command))

    def stay_in_mode(self, mode: int | None) -> None:
        """Of operation, whatever it is told (6060); None: as it is told from now on."""
        self._stuck_mode = mode
        told = self.objects.get(0x6060)
        self.objects.set(0x6061, 0, told if mode is None else mode)

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        """See `Device`."""
        if frame.id == NMT:
            self._network_management(frame.data)
        elif frame.id == SYNC.id:
            self._synchronise()
        elif frame.id == 0x600 + self.node:
            self._serve(frame.data)
        elif frame.id == 0x700 + (self._heartbeat_consumer >> 16 & 0x7F):
            self._host_heard = time
        elif self.nmt is NmtState.OPERATIONAL:
            self._process(frame)
        return self._sent()

    def advance(self, time: float) -> list[Frame]:
        """See `Device`."""
        if self.nmt is NmtState.BOOT_UP:
            self._outbox.append(heartbeat(self.node, NmtState.BOOT_UP))
            self.nmt = NmtState.PRE_OPERATIONAL
        self._watch(time)
        self._power.advance(time)
        if self._heartbeat.due(time):
            self._outbox.append(heartbeat(self.node, self.nmt))
        return self._sent()

    # Network

    @property
    def _heartbeat_consumer(self) -> int:
        return self.objects.get(0x1016, 1)

    def _network_management(self, data: bytes) -> None:
        if len(data) != 2 or data[1] not in (0, self.node):
            return
        if data[0] in (NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION):
            self._power_up()
        elif data[0] in [*NmtCommand]:
            self.nmt = _NMT_STATES[NmtCommand(data[0])]

    def _watch(self, time: float) -> None:
        """From the first heartbeat of the host on: has it stopped?"""
        timeout = (self._heartbeat_consumer & 0xFFFF) / 1000
        if self._host_heard is None or timeout == 0 or time - self._host_heard <= timeout:
            return
        self._host_heard = None
        behaviour = self.objects.get(0x1029, 1)
        if self.nmt is NmtState.OPERATIONAL and behaviour != 1:
            self.nmt = NmtState.STOPPED if behaviour == 2 else NmtState.PRE_OPERATIONAL
        option = self.objects.get(0x6007, missing=1)
        if option == 1:
            self.fail(HEARTBEAT_LOST, time)
            return
        self._emergency(HEARTBEAT_LOST)
        if option in (2, 3):
            self._power.disable()

    def _synchronise(self) -> None:
        if self.nmt is not NmtState.OPERATIONAL:
            return
        self._measure()
        self._outbox += [Frame(cob_id, data) for cob_id, data in self._pdos.on_sync()]

    def _process(self, frame: Frame) -> None:
        received = self._pdos.receive(frame.id, frame.data)
        if received is None:
            self._emergency(_PDO_TOO_SHORT)
            return
        for (index, subindex), value in received.items():
            self.objects.set(index, subindex, value)
            self._written(index, subindex, value)

    def _serve(self, data: bytes) -> None:
        if self.nmt is NmtState.STOPPED:
            return
        self._measure()
        answer = self._sdo.answer(data)
        if answer is not None:
            self._outbox.append(Frame(0x580 + self.node, answer))

    def _emergency(self, error: int) -> None:
        register = 0x00 if error == 0 else 0x11 if error & 0xFF00 == 0x8100 else 0x01
        self.objects.set(0x1001, 0, register)
        cob_id = self.objects.get(0x1014) & 0x7FF
        self._outbox.append(Frame(cob_id, struct.pack("<HB5x", error, register)))

    def _sent(self) -> list[Frame]:
        outbox, self._outbox = self._outbox, []
        return outbox

    # Drive

    def _written(self, index: int, subindex: int, value: int) -> None:
        del subindex
        if index == 0x6040 and self._power.control(value):
            self.objects.set(0x603F, 0, 0)
            self._emergency(0)
        elif index == 0x6060:
            self.objects.set(0x6061, 0, value if self._stuck_mode is None else self._stuck_mode)
        elif index == 0x605A:
            self._power.quick_stop_option = value
        elif index == 0x1017:
            self._heartbeat = Periodic(value / 1000)

    def _acting(self) -> int:
        """Per mille of rated torque."""
        enabled = self._power.state is State.OPERATION_ENABLED
        if not enabled or self.objects.get(0x6061) != CYCLIC_SYNCHRONOUS_TORQUE:
            return 0
        limit = self.objects.get(0x6072)
        asked = self.objects.get(0x6071) + self.objects.get(0x60B2)
        torque = max(-limit, min(limit, asked))
        too_fast = abs(self.motor.rpm(self.rate)) > self.objects.get(0x6080)
        return 0 if too_fast and torque * self.rate > 0 else torque

    def _measure(self) -> None:
        self.objects.set(0x6041, 0, self._power.statusword)
        offset = 1000 * self.offset / self.motor.rated_torque
        self.objects.set(0x6077, 0, round(self.strength * self._acting() + offset))
        self.objects.set(0x6064, 0, self.motor.position(self.angle))
        self.objects.set(0x606C, 0, self.motor.velocity(self.rate))
