"""A CiA 402 drive in cyclic synchronous torque mode, as the loop has it."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from bikesim.bench.cia402 import (
    CYCLIC_SYNCHRONOUS_TORQUE,
    DISABLE_VOLTAGE,
    Goal,
    NmtState,
    State,
    next_controlword,
    state_of,
)
from bikesim.bench.cia402_findings import Said, cia402_findings
from bikesim.bench.cia402_frames import (
    SYNC,
    CobIds,
    DriveCommand,
    heartbeat,
    pack_command,
    unpack_emergency,
    unpack_heartbeat,
    unpack_motion,
    unpack_status,
)
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drive import Cyclic, DriveView
from bikesim.bench.finding import Finding
from bikesim.bench.frame import Frame

if TYPE_CHECKING:
    import can


class _Answer:
    """Of the drive to SYNC: each of its messages has an age of its own, as each may stop alone.

    `seen` [s]: when it came last; `asked` [s]: when the oldest SYNC left that it has not answered.
    """

    __slots__ = ("asked", "seen")

    def __init__(self) -> None:
        self.seen, self.asked = -math.inf, math.inf

    def ask(self, time: float) -> None:
        if self.asked == math.inf:
            self.asked = time

    def take(self, time: float) -> None:
        self.seen, self.asked = time, math.inf


class Cia402Drive:
    """See `Drive`. A fault is reset only on the way to being enabled for the first time.

    A drive whose host was silent since it was set up is in fault for that; one that fails while
    it is enabled stays where it is until a person starts anew.
    """

    def __init__(self, settings: Cia402Settings) -> None:
        self._settings = settings
        self._scale = settings.scale
        self._cob = CobIds.of_node(settings.node)
        self._heartbeat = heartbeat(settings.host_node)
        # Three may get lost before the drive disables itself.
        self._heartbeat_pause = settings.heartbeat_timeout / 4
        self._next_heartbeat = -math.inf
        self._controlword = DISABLE_VOLTAGE
        self._state = State.UNKNOWN
        self._statusword: int | None = None
        self._rated: float | None = None
        self._mode = 0  # until it says
        self._torque = self._steer = self._steer_rate = 0.0
        self._heard = -math.inf
        self._status, self._motion = _Answer(), _Answer()
        self._error = ""
        self._armed = False
        self._last_error = 0
        self._nmt = NmtState.OPERATIONAL

    @property
    def name(self) -> str:
        return f"CiA 402 drive {self._settings.node}"

    @property
    def heartbeat_period(self) -> float:
        return self._settings.heartbeat_period

    @property
    def watchdog_timeout(self) -> float:
        return self._settings.heartbeat_timeout

    @property
    def ids(self) -> frozenset[int]:
        return frozenset(self._cob.from_drive)

    @property
    def host_ids(self) -> frozenset[int]:
        return frozenset(self._cob.to_drive(self._settings.host_node))

    def set_up(self, bus: "can.BusABC", *, prove: bool = True) -> tuple[str, ...]:
        from bikesim.bench.cia402_setup import set_up
        from bikesim.bench.cia402_watchdog import prove_watchdog
        from bikesim.bench.link import BusLink

        report = set_up(bus, self._settings)
        self._rated = report.rated_torque
        silent = prove_watchdog(BusLink(bus), self._settings) if prove else None
        proven = f"disabled it {1e3 * silent:.0f} ms after the last heartbeat" if silent else ""
        return (
            f"{self.name}: {report.name or 'without a name'}, rated {report.rated_torque:g} N m",
            *((report.fault,) if report.fault else ()),
            f"its watchdog {proven or 'was not tried'}",
            *(f"it has no {what}" for what in report.missing),
        )

    def receive(self, frame: Frame, time: float) -> None:
        identifier, data = frame.id, frame.data
        if identifier == self._cob.status:
            self._take_status(data, time)
        elif identifier == self._cob.motion:
            self._take_motion(data, time)
        elif identifier == self._cob.heartbeat:
            nmt = unpack_heartbeat(data)
            if nmt is not None:
                self._heard, self._nmt = time, nmt
        elif identifier == self._cob.emergency:
            self._take_emergency(data)

    def command(
        self, torque: float, *, enable: bool, on_time: bool = True
    ) -> tuple[list[Frame], float]:
        del on_time  # the heartbeat feeds its watchdog, this frame does not
        goal = self._goal(enable)
        self._controlword = next_controlword(goal, self._state, self._controlword)
        enabled = enable and self._state is State.OPERATION_ENABLED
        units = self._scale.to_drive(torque) if enabled else 0
        return [self._command(units)], self._scale.torque(units)

    def _goal(self, enable: bool) -> Goal:
        if not enable:
            self._armed, self._error = False, ""
            return Goal.DISABLED
        if self._armed or self._state is not State.FAULT:
            return Goal.ENABLED
        return Goal.RESET

    def upkeep(self, time: float, *, on_time: bool = True) -> list[Frame]:
        self._status.ask(time)
        self._motion.ask(time)
        if not on_time or time < self._next_heartbeat:
            return [SYNC]
        self._next_heartbeat = time + self._heartbeat_pause
        return [SYNC, self._heartbeat]

    def farewell(self) -> list[Frame]:
        self._controlword = DISABLE_VOLTAGE
        return [self._command(0), SYNC]

    def traffic(self, period: float) -> tuple[tuple[int, float], ...]:
        ours, theirs = 1 / self._heartbeat_pause, 1 / self._settings.heartbeat_period
        in_a_tick = (5, 0, 8, 7)  # RPDO1, SYNC, TPDO1, TPDO2
        return (*((size, 1 / period) for size in in_a_tick), (1, ours), (1, theirs))

    def cyclic(self, period: float) -> tuple[Cyclic, ...]:
        return (
            Cyclic(self._cob.heartbeat, "heartbeat", 1 / self._settings.heartbeat_period),
            Cyclic(self._cob.status, "status", 1 / period),
            Cyclic(self._cob.motion, "motion", 1 / period),
        )

    def findings(self) -> Iterator[Finding]:
        moved = self._motion.seen > -math.inf
        said = Said(
            self._nmt if self._heard > -math.inf else None,
            self._statusword,
            self._mode if moved else None,
            self._last_error if moved else None,
            self._rated,
        )
        return cia402_findings(self._settings, said)

    def view(self, time: float) -> DriveView:
        status, motion = self._status, self._motion
        return DriveView(
            time - min(status.seen, motion.seen),
            max(time - min(status.asked, motion.asked), 0.0),
            time - self._heard,
            self._state is State.OPERATION_ENABLED,
            self._trouble(),
            self._error,
            self._torque,
            self._steer,
            self._steer_rate,
        )

    def _command(self, units: int) -> Frame:
        command = DriveCommand(self._controlword, units, CYCLIC_SYNCHRONOUS_TORQUE)
        return Frame(self._cob.command, pack_command(command))

    def _take_status(self, data: bytes, time: float) -> None:
        status = unpack_status(data)
        if status is None:
            self._error = f"{self.name} sends {len(data)} bytes where its status has 8"
            return
        self._status.take(time)
        self._statusword, self._state = status.statusword, state_of(status.statusword)
        if self._state is State.OPERATION_ENABLED and not self._armed:
            self._armed, self._error = True, ""
        self._torque = self._scale.torque(status.torque)
        self._steer = self._scale.steer(status.position)

    def _take_motion(self, data: bytes, time: float) -> None:
        motion = unpack_motion(data)
        if motion is None:
            self._error = f"{self.name} sends {len(data)} bytes where its motion has 7"
            return
        self._motion.take(time)
        self._mode, self._last_error = motion.mode, motion.error
        self._steer_rate = self._scale.steer_rate(motion.velocity)
        if motion.error and self._armed:
            self._error = self._error or f"{self.name} has error {motion.error:#06x}"

    def _take_emergency(self, data: bytes) -> None:
        emergency = unpack_emergency(data)
        if emergency is not None and emergency.error and self._armed:
            self._error = f"{self.name} reports error {emergency.error:#06x}"

    def _trouble(self) -> str:
        if self._mode != CYCLIC_SYNCHRONOUS_TORQUE:
            return f"{self.name} is in mode {self._mode}"
        if self._nmt is not NmtState.OPERATIONAL:
            return f"{self.name} is {self._nmt.name.replace('_', ' ').lower()}"
        if self._state is not State.OPERATION_ENABLED:
            error = f", error {self._last_error:#06x}" if self._last_error else ""
            return f"{self.name} is in {self._state.told}{error}"
        return ""
