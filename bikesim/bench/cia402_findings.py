"""What `bench check` says of a CiA 402 drive."""

from collections.abc import Iterator
from typing import NamedTuple

from bikesim.bench.cia402 import (
    CYCLIC_SYNCHRONOUS_TORQUE,
    HEARTBEAT_LOST,
    NmtState,
    State,
    state_of,
)
from bikesim.bench.cia402_errors import error_told
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.finding import Finding
from bikesim.bench.rated_torque import UNITS

_NOT_TOLD = "not told"


class Said(NamedTuple):
    """By the drive; None: not yet. `rated`: torque [N m], object 6076 in the profile's unit."""

    nmt: NmtState | None
    statusword: int | None
    mode: int | None
    error: int | None
    rated: float | None


def cia402_findings(drive: Cia402Settings, said: Said) -> Iterator[Finding]:
    """Of one that is set up and disabled."""
    network = _NOT_TOLD if said.nmt is None else said.nmt.name.replace("_", " ").lower()
    started = said.nmt is NmtState.OPERATIONAL
    yield Finding(started, "drive: network state", network, "operational")
    yield _state(said)
    yield _error(said.error)
    wanted = CYCLIC_SYNCHRONOUS_TORQUE
    mode = _NOT_TOLD if said.mode is None else str(said.mode)
    yield Finding(said.mode == wanted, "drive: mode (6061)", mode, f"{wanted} (torque)")
    yield _units(drive, said.rated)


def _state(said: Said) -> Finding:
    found, good = _NOT_TOLD, False
    if said.statusword is not None:
        state = state_of(said.statusword)
        found = f"{state.told} (6041 = {said.statusword:#06x})"
        # Between its set-up and this look the host was silent, which may be a fault already.
        silence = state is State.FAULT and said.error == HEARTBEAT_LOST
        good = state is State.SWITCH_ON_DISABLED or silence
    return Finding(good, "drive: state", found, State.SWITCH_ON_DISABLED.told)


def _error(error: int | None) -> Finding:
    found = _NOT_TOLD if error is None else error_told(error) if error else "none"
    return Finding(error in (0, HEARTBEAT_LOST), "drive: error (603F)", found, "none")


def _units(drive: Cia402Settings, rated: float | None) -> Finding:
    """The set-up refuses what contradicts: it is for a person to see which unit that was."""
    found, unit = _NOT_TOLD, drive.torque_unit
    if rated is not None:
        found = f"6076 = {rated / UNITS[unit]:.0f} {unit} = {rated:g} N m"
    wanted = f"nameplate {drive.rated_torque:g} N m"
    return Finding(rated is not None, "drive: rated torque", found, wanted)
