"""The drive's part of `bench check`: set up, looked at, and sent the commissioning pulse."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from bikesim.bench.bus import filter_for
from bikesim.bench.drive import Drive
from bikesim.bench.drives import make_drive
from bikesim.bench.finding import Finding
from bikesim.bench.look import look
from bikesim.bench.parts import Parts, loop_port
from bikesim.bench.profile import BenchSettings
from bikesim.clock import RealTimeClock
from bikesim.errors import InputError
from bikesim.realtime import real_time

if TYPE_CHECKING:
    import can


def check_drive(
    bus: "can.BusABC", bench: BenchSettings, drive: Drive, *, well: bool, pulse: bool
) -> Iterable[Finding]:
    """It is set up and looked at, disabled; `well`: what was heard so far.

    Only then is it enabled: at zero torque for the proof of its watchdog, and for the `pulse` that
    is wanted, if all is well with the drive too. Raises nothing.
    """
    # From the set-up on: a drive whose host stops to collect garbage meanwhile is in fault for it.
    with real_time():
        is_set_up = False
        try:
            filter_for(bus, drive.ids)
            lines = drive.set_up(bus, prove=well)
            # What it does not have, it need not have.
            findings = [Finding(True, "drive", line, "as in the profile") for line in lines]
            is_set_up = True
        except InputError as error:
            findings = [Finding(False, "drive", str(error), "as in the profile")]
        try:
            filter_for(bus, None)
            port = loop_port(bus, bench, drive)
            findings += look(port, bench, drive, ask=is_set_up)
        except InputError as error:
            findings.append(Finding(False, "drive: the bus meanwhile", str(error), "no trouble"))
        if pulse and well and all(one.good for one in findings):
            findings += _of_pulse(bus, bench)
    return findings


def _of_pulse(bus: "can.BusABC", bench: BenchSettings) -> Iterable[Finding]:
    findings: list[Finding] = []
    drive = make_drive(bench.drive)  # anew: the clock of the loop begins anew too
    parts = Parts(bench, drive, loop_port(bus, bench, drive), RealTimeClock(bench.period))
    try:
        parts.arm()
        findings.append(Finding(True, "commissioning pulse", parts.pulse(), "within 30 %"))
    except InputError as error:
        findings.append(Finding(False, "commissioning pulse", str(error), "within 30 %"))
    finally:
        parts.rig.close()
    disabled = parts.rig.disabled is True
    said = "disabled" if disabled else "it did not say that it is disabled"
    findings.append(Finding(disabled, "drive, at the end", said, "disabled"))
    return findings
