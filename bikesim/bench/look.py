"""A drive looked at for a moment while it is disabled: asked as in the loop, told no torque."""

import math
import time
from collections import Counter
from collections.abc import Iterator

from bikesim.bench.drive import Drive, DriveView
from bikesim.bench.finding import Finding
from bikesim.bench.frame import Frame
from bikesim.bench.profile import BenchSettings
from bikesim.bench.rig import Port

_SETTLE, _LOOK = 0.05, 0.5  # s
_RATE_WITHIN = 0.05
_MANY = 1000  # frames taken in a row, else a flood would never end


def look(port: Port, bench: BenchSettings, drive: Drive, *, ask: bool = True) -> list[Finding]:
    """Rates, ages and what the drive says of itself, after its set-up. Raises nothing.

    `drive` keeps times of this look: for anything else make a fresh one. Without `ask` nothing is
    sent: how a drive that could not be set up takes it is not known.
    """
    return list(_Look(port, bench, drive, ask).findings())


class _Look:
    def __init__(self, port: Port, bench: BenchSettings, drive: Drive, ask: bool) -> None:
        self._port, self._bench, self._drive, self._ask = port, bench, drive, ask
        self._forget()

    def _forget(self) -> None:
        self._counts: Counter[int] = Counter()
        self._ticks = 0
        self._silent = self._heartbeat = 0.0

    def findings(self) -> Iterator[Finding]:
        beat = self._drive.heartbeat_period
        self._pass(max(_SETTLE, 1.5 * beat))
        self._forget()
        began = time.monotonic()
        view = self._pass(max(_LOOK, 5 * beat))
        took = time.monotonic() - began
        self._wait(time.monotonic() + _SETTLE / 10)  # echoes of what was sent last
        if self._port.trouble:
            yield Finding(False, "drive: the bus meanwhile", self._port.trouble, "no trouble")
        if self._ticks:
            yield from self._rates(took)
        yield from self._ages()
        yield from self._drive.findings()
        if view.age < math.inf:
            most = self._bench.thresholds.rest_torque
            torque = f"{view.torque:+.2f} N m"
            yield Finding(
                abs(view.torque) <= most, "drive: torque measured", torque, f"at most {most:g}"
            )
        if self._bench.bar.source == "drive":
            yield from self._bar(view)

    def _pass(self, duration: float) -> DriveView:
        """Ticks as the loop would; what came is taken before it is judged how old all is."""
        period = self._bench.period
        due = time.monotonic()
        end = due + duration
        view = self._drive.view(due)
        while due < end and not self._port.trouble:
            self._take_all()
            now = time.monotonic()
            view = self._drive.view(now)
            self._silent = max(self._silent, view.silent)
            self._heartbeat = max(self._heartbeat, view.heartbeat_age)
            frames = self._drive.upkeep(now)
            if self._ask:
                self._port.send(frames)
            self._ticks += 1
            due = due + period if due + period > now else now + period
            self._wait(due)
        return view

    def _wait(self, until: float) -> None:
        while (left := until - time.monotonic()) > 0 and not self._port.trouble:
            self._take(self._port.receive(left))

    def _take_all(self) -> None:
        for _ in range(_MANY):
            if not self._take(self._port.receive(0.0)):
                return

    def _take(self, frame: Frame | None) -> bool:
        if frame is not None and frame.id in self._drive.ids:
            self._counts[frame.id] += 1
            self._drive.receive(frame, time.monotonic())
        return frame is not None

    def _rates(self, took: float) -> Iterator[Finding]:
        for one in self._drive.cyclic(took / self._ticks):
            count, wanted = self._counts[one.id], one.rate * took
            yield Finding(
                abs(count - wanted) <= 1 + _RATE_WITHIN * wanted,
                f"drive: {one.name} {one.id:#05x}",
                f"{count / took:.0f} a second",
                f"{one.rate:.0f}",
            )

    def _ages(self) -> Iterator[Finding]:
        thresholds = self._bench.thresholds
        oldest = thresholds.drive_heartbeats * self._drive.heartbeat_period
        for name, age, most in (
            ("heartbeat", self._heartbeat, oldest),
            ("data owed", self._silent, thresholds.drive_age),
        ):
            told = f"{1e3 * age:.1f} ms" if age < math.inf else "never came"
            yield Finding(age <= most, f"drive: {name}, longest pause", told, f"{1e3 * most:g} ms")

    def _bar(self, view: DriveView) -> Iterator[Finding]:
        """No second sensor, and no node that sees the emergency stop."""
        told = view.age < math.inf
        steer = view.steer - self._bench.bar.drive_zero
        found = f"{steer:+.4f} rad, {view.steer_rate:+.4f} rad/s" if told else "not told"
        still = told and abs(view.steer_rate) < 0.05
        yield Finding(still, "bar, by the drive's encoder", found, "at rest")
        yield Finding(True, "emergency stop", "not seen by the host", "closed, in your hand")
