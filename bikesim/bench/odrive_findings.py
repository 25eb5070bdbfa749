"""What `bench check` says of an ODrive."""

from collections.abc import Iterator
from typing import NamedTuple

from bikesim.bench.finding import Finding
from bikesim.bench.odrive import AxisError, AxisState, errors_told
from bikesim.bench.odrive_settings import ODriveSettings

# Of firmware 0.6 (its API reference, AxisState).
_STATES = {
    0: "undefined", 1: "idle", 2: "startup sequence", 3: "full calibration sequence",
    4: "motor calibration", 6: "encoder index search", 7: "encoder offset calibration",
    8: "closed-loop control", 9: "lock-in spin", 10: "encoder direction search", 11: "homing",
    12: "encoder Hall polarity calibration", 13: "encoder Hall phase calibration",
    14: "anticogging calibration",
}  # fmt: skip

_NOT_TOLD = "not told"


class Said(NamedTuple):
    """By the ODrive; None: not yet."""

    state: int | None
    errors: int | None
    disarm_reason: int | None


def odrive_findings(drive: ODriveSettings, said: Said) -> Iterator[Finding]:
    """Of one that is set up and idle. CANSimple has no message for mode and torque constant."""
    state = _NOT_TOLD
    if said.state is not None:
        state = f"{_STATES.get(said.state, 'unknown')} ({said.state})"
    yield Finding(said.state == AxisState.IDLE, "drive: state", state, "idle")
    # While it is idle nothing feeds its watchdog, and the set-up's proof lets it run out.
    yield _errors("drive: errors", said.errors)
    yield _errors("drive: disarmed last by", said.disarm_reason)
    yield Finding(True, "drive: mode", "not readable", "torque, as the set-up wrote")
    constant = f"profile {drive.torque_constant:g} N m/A"
    yield Finding(True, "drive: torque constant", "not readable", constant)


def _errors(what: str, errors: int | None) -> Finding:
    if errors is None:
        return Finding(False, what, _NOT_TOLD, "none")
    found = errors_told(errors) if errors else "none"
    if errors == AxisError.WATCHDOG_TIMER_EXPIRED:
        found += ": this host was silent"
    return Finding(not errors & ~AxisError.WATCHDOG_TIMER_EXPIRED, what, found, "none")
