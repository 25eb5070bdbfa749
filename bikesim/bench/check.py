"""Who answers on a bench's bus, and how well."""

import time
from collections import defaultdict
from collections.abc import Iterable
from typing import TYPE_CHECKING

from bikesim.bench.bus import close_bus, open_bus
from bikesim.bench.bus_errors import received
from bikesim.bench.calibration_check import calibration_finding, link_to_node
from bikesim.bench.check_drive import check_drive
from bikesim.bench.continuity import BadFrame, Flaw
from bikesim.bench.database import (
    STEER_COMMAND,
    STEER_DIAG,
    STEER_REPLY,
    STEER_STATE,
    WHEEL_SPEED,
    cycle_time,
    message,
)
from bikesim.bench.drive import Drive
from bikesim.bench.drives import make_drive
from bikesim.bench.finding import Finding
from bikesim.bench.frame import from_message
from bikesim.bench.preflight import checked_load
from bikesim.bench.profile import BenchSettings
from bikesim.bench.profile_file import change_profile, own_profile
from bikesim.bench.sensor_node import SteerDecoder, SteerReading
from bikesim.bench.wheel_node import WheelDecoder, WheelReading
from bikesim.errors import InputError

if TYPE_CHECKING:
    import can

_LISTEN = 1.0  # s
_RATE_WITHIN = 0.05
_CLOCK_WITHIN = 1e-3
_NAMED = 8


def check(bench: BenchSettings, *, pulse: bool = False) -> list[Finding]:
    """Listens, then sets the drive up and looks at it, disabled. Raises InputError without a bus.

    It is enabled, at zero torque for the proof of its watchdog, only where all else is well.
    `pulse`: then also arms it and sends the commissioning pulse.
    """
    drive = make_drive(bench.drive)
    load = checked_load(bench, drive)
    findings = [Finding(True, "bus load, at worst", f"{100 * load:.0f} %", "at most 90 %")]
    heard = _Heard(bench, drive)
    bus = open_bus(bench.bus)
    try:
        heard.listen(bus)
        findings += heard.findings()
        if heard.is_disturbed:
            wanted = "no error frames, no other host"
            findings.append(Finding(False, "drive", "not asked: see above", wanted))
        else:
            if bench.bar.source == "node":
                findings.append(calibration_finding(link_to_node(bus), bench.bar.calibration))
            well = all(one.good for one in findings)
            findings += check_drive(bus, bench, drive, well=well, pulse=pulse)
    finally:
        close_bus(bus)
    return findings


class _Heard:
    """What came in a second of listening, nothing being sent."""

    def __init__(self, bench: BenchSettings, drive: Drive) -> None:
        self._bench, self._drive = bench, drive
        self._steer = SteerDecoder()
        self._wheel = None if bench.wheel is None else WheelDecoder(bench.wheel)
        self._counts: dict[int, int] = defaultdict(int)
        self._flaws: dict[int, list[Flaw]] = defaultdict(list)
        self._lost: dict[int, int] = defaultdict(int)
        self._gaps: dict[int, float] = defaultdict(float)
        self._last: dict[int, float] = {}
        self._times: dict[int, list[tuple[float, float]]] = defaultdict(list)
        self._newest: SteerReading | None = None
        self._newest_wheel: WheelReading | None = None
        self._errors = 0

    def listen(self, bus: "can.BusABC") -> None:
        began = time.monotonic()
        while (left := began + _LISTEN - time.monotonic()) > 0:
            came = received(bus, left)
            if came is None:
                return
            now = time.monotonic()
            self._errors += came.is_error_frame
            frame = from_message(came)
            if frame is not None:
                self._take(frame.id, frame.data, now)

    def _take(self, identifier: int, data: bytes, now: float) -> None:
        self._counts[identifier] += 1
        if identifier in self._last:
            gap = now - self._last[identifier]
            self._gaps[identifier] = max(self._gaps[identifier], gap)
        self._last[identifier] = now
        if identifier == self._steer.id:
            reading = self._steer.decode(data, now)
            self._keep(identifier, reading, now)
            self._newest = reading if isinstance(reading, SteerReading) else self._newest
        elif self._wheel is not None and identifier == self._wheel.id:
            reading = self._wheel.decode(data, now)
            self._keep(identifier, reading, now)
            if isinstance(reading, WheelReading):
                self._newest_wheel = reading

    def _keep(self, one: int, reading: SteerReading | WheelReading | BadFrame, now: float) -> None:
        if isinstance(reading, BadFrame):
            self._flaws[one].append(reading.flaw)
            return
        self._lost[one] += reading.lost
        self._times[one].append((now, reading.time))

    @property
    def is_disturbed(self) -> bool:
        """Whether nothing may be sent."""
        return self._errors > 0 or any(self._counts[one] for one in self._masters())

    def _masters(self) -> frozenset[int]:
        """What only a host sends."""
        node = {message(STEER_COMMAND).frame_id} if self._bench.bar.source == "node" else set()
        return self._drive.host_ids | node

    def _others(self) -> str:
        """Who sends what is nobody's of the profile."""
        known = self._drive.ids | self._masters()
        if self._bench.bar.source == "node":
            known |= {message(one).frame_id for one in (STEER_STATE, STEER_DIAG, STEER_REPLY)}
        if self._wheel is not None:
            known |= {self._wheel.id}
        others = sorted(one for one, count in self._counts.items() if count and one not in known)
        named = ", ".join(f"{one:#05x}" for one in others[:_NAMED])
        return f"{named} and {len(others) - _NAMED} more" if len(others) > _NAMED else named

    def findings(self) -> list[Finding]:
        masters = [f"{one:#05x}" for one in sorted(self._masters()) if self._counts[one]]
        findings = [
            Finding(not self._errors, "error frames", str(self._errors), "0"),
            Finding(not masters, "another host", ", ".join(masters) or "none", "none"),
            Finding(True, "ids of nobody in the profile", self._others() or "none", "none"),
        ]
        if self._bench.bar.source == "node":
            findings += self._sensor("sensor node", STEER_STATE)
            findings += self._steer_findings()
        if self._wheel is not None:
            findings += self._sensor("speed sensor", WHEEL_SPEED)
            wheel = self._newest_wheel
            ok = wheel is not None and wheel.sensor_ok
            speed = "nothing" if wheel is None else f"{wheel.speed:.2f} m/s"
            findings.append(Finding(ok, "speed sensor says", speed, "sensor_ok"))
        return findings

    def _sensor(self, name: str, what: str) -> Iterable[Finding]:
        one, period = message(what).frame_id, cycle_time(message(what))
        rate, should = self._counts[one] / _LISTEN, 1 / period
        yield Finding(
            abs(rate / should - 1) <= _RATE_WITHIN,
            f"{name}: frames of {one:#05x}",
            f"{rate:.0f} a second",
            f"{should:.0f}",
        )
        if not self._counts[one]:
            return
        bad = len(self._flaws[one])
        crc = self._flaws[one].count(Flaw.CRC)
        flaws = f"{crc} with a wrong checksum, {bad - crc} others"
        yield Finding(bad == 0, f"{name}: bad frames", flaws, "none")
        lost = self._lost[one]
        yield Finding(lost <= 0.01 * should, f"{name}: lost", str(lost), "less than 1 %")
        oldest = self._bench.thresholds.ramp_age if what == STEER_STATE else 0.1
        gap = self._gaps[one]
        yield Finding(
            gap <= oldest, f"{name}: longest pause", f"{1e3 * gap:.1f} ms", f"{1e3 * oldest:g} ms"
        )
        yield self._clock(name, one)

    def _clock(self, name: str, one: int) -> Finding:
        times = self._times[one]
        ratio = 0.0
        if len(times) > 1:
            (a, b), (c, d) = times[0], times[-1]
            ratio = (d - b) / (c - a) if c > a else 0.0
        # Two arrivals, each up to a pause late, are all that the host has to compare with.
        within = _CLOCK_WITHIN + 2 * self._gaps[one] / _LISTEN
        good = abs(ratio - 1) <= within
        return Finding(good, f"{name}: its clock", f"{ratio:.4f} of ours", f"1 ± {within:.3f}")

    def _steer_findings(self) -> Iterable[Finding]:
        seen = self._newest
        if seen is None:
            return
        for name, good in (
            ("potentiometer", seen.pot_ok),
            ("gyro", seen.gyro_ok),
            ("reference voltage", seen.vref_ok),
        ):
            yield Finding(good, f"sensor node: {name}", "ok" if good else "out of range", "ok")
        estop = "closed" if seen.estop_closed else "open"
        yield Finding(seen.estop_closed, "emergency stop", estop, "closed")
        still = abs(seen.steer_rate) < 0.05
        found = f"{seen.steer:+.4f} rad, {seen.steer_rate:+.4f} rad/s"
        yield Finding(still, "bar", found, "at rest")


def remember(name: str, bench: BenchSettings) -> str:
    """Writes into the profile that it passed the pulse; says so, or what a person is to write.

    A profile that ships is not written to.
    """
    mark = f'commissioned = "{bench.commissioning}"'
    if bench.commissioned == bench.commissioning:
        return f"passed; as the profile says: {mark}"
    try:
        path = own_profile(name)
        kept = change_profile(path, {"commissioned": bench.commissioning})
    except InputError as error:
        return f"passed; write into a profile of your own: {mark} ({error})"
    return f"passed; in {path}: {mark}; as it was: {kept}"
