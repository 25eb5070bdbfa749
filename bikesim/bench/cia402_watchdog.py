"""Proves that a CiA 402 drive disables itself when the host's heartbeat stops.

What is written in object 1016 is a promise; only the drive's own reaction counts. It is enabled
at zero torque, the host falls silent, and the drive must leave "operation enabled" in time. It is
not enabled, or no longer, if it measures a torque all the same.
"""

from bikesim.bench.cia402 import (
    CYCLIC_SYNCHRONOUS_TORQUE,
    DISABLE_VOLTAGE,
    Goal,
    State,
    next_controlword,
    state_of,
)
from bikesim.bench.cia402_frames import (
    SYNC,
    CobIds,
    DriveCommand,
    heartbeat,
    pack_command,
    unpack_status,
)
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.frame import Frame
from bikesim.bench.link import Link, until
from bikesim.bench.rest_torque import check_rest_torque
from bikesim.errors import InputError

_PERIOD = 0.002  # s, between two of our cycles
_PATIENCE = 1.0  # s, to enable or to reset
_HOLD = 0.05  # s, enabled before the silence
_LATE = 0.02  # s, beyond the time-out; a drive counts in whole ms, an operating system is late


def prove_watchdog(link: Link, drive: Cia402Settings) -> float:
    """How long after the last heartbeat the drive was no longer enabled [s].

    For a drive that is set up and disabled; it is disabled again, without a fault, afterwards.
    Raises InputError if it stayed enabled, could not be enabled, or measured a torque (fault 25).
    """
    return _Proof(link, drive).run()


class _Proof:
    def __init__(self, link: Link, drive: Cia402Settings) -> None:
        self._link, self._drive = link, drive
        self._ids = CobIds.of_node(drive.node)
        self._state = State.UNKNOWN
        self._last = DISABLE_VOLTAGE

    def run(self) -> float:
        try:
            self._bring(Goal.ENABLED, State.OPERATION_ENABLED)
            self._hold()
            silent = self._silence()
            self._bring(Goal.RESET, State.SWITCH_ON_DISABLED)
        finally:
            self._command(DISABLE_VOLTAGE)
        return silent

    def _bring(self, goal: Goal, state: State) -> None:
        deadline = self._link.now() + _PATIENCE
        while self._state is not state:
            if self._link.now() > deadline:
                raise self._error(f"stays in {self._state.told}, should be {state.told}")
            self._cycle(goal)

    def _hold(self) -> None:
        end = self._link.now() + _HOLD
        while self._link.now() < end:
            self._cycle(Goal.ENABLED)
        if self._state is not State.OPERATION_ENABLED:
            raise self._error(f"is in {self._state.told} while it has heartbeats")

    def _silence(self) -> float:
        """No heartbeat. SYNC and commands go on: they must not keep the drive alive."""
        self._link.send(heartbeat(self._drive.host_node))
        last = self._link.now()
        allowed = self._drive.heartbeat_timeout + _LATE
        while self._state is State.OPERATION_ENABLED:
            if self._link.now() - last > allowed + _PERIOD:
                raise self._error(
                    f"is still enabled {self._link.now() - last:.3f} s after the host's last "
                    f"heartbeat, should be disabled after {self._drive.heartbeat_timeout:g} s"
                )
            self._command(next_controlword(Goal.ENABLED, self._state, self._last))
            self._listen()
        return self._link.now() - last

    def _cycle(self, goal: Goal) -> None:
        self._link.send(heartbeat(self._drive.host_node))
        self._command(next_controlword(goal, self._state, self._last))
        self._listen()

    def _command(self, controlword: int) -> None:
        self._last = controlword
        command = DriveCommand(controlword, 0, CYCLIC_SYNCHRONOUS_TORQUE)
        self._link.send(Frame(self._ids.command, pack_command(command)))

    def _listen(self) -> None:
        self._link.send(SYNC)
        for frame in until(self._link, self._link.now() + _PERIOD):
            if frame.id == self._ids.status and (status := unpack_status(frame.data)):
                # Before its state is taken: nothing is enabled that has not been seen at rest.
                check_rest_torque(self._drive.scale.torque(status.torque))
                self._state = state_of(status.statusword)

    def _error(self, what: str) -> InputError:
        return InputError(f"drive {self._drive.node}: {what}")
