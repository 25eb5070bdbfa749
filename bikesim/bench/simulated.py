"""An emulated bench in lock-step with its host: time passes when the loop waits, and only then."""

import math
import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Protocol

import can

from bikesim.bench.drive import Drive
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.pump import Pump, PumpThread
from bikesim.bench.frame import Frame
from bikesim.bench.odrive_drive import ODrive
from bikesim.clock import Wake

Tampering = Callable[[Frame, float], Iterable[Frame]]
"""What becomes of a frame on the wire, at a time [s]."""


class Emulated(Protocol):
    """What is on the bus, and behind it: a plant, or something simpler."""

    @property
    def devices(self) -> tuple[Device, ...]: ...

    def advance(self) -> None:
        """A period on."""
        ...


class SimulatedBench:
    """An ideal bus, its clock and what is on it; `Clock` and `Port` of a `BenchRig` at once.

    A frame arrives when it is sent, the physics advances one period at each deadline, and the
    sensors sample at the deadline: what a virtual rig does.
    """

    def __init__(self, plant: Emulated, period: float) -> None:
        self.plant, self._period = plant, period
        self.trouble = ""
        self.wakes_late = 200e-6
        self.closed = False
        self.tamper: Tampering | None = None
        """On the way from the devices."""
        self.tamper_host: Tampering | None = None
        """On the way from the host."""
        self.hang = 0.0
        """The host oversleeps its next deadline by so much [s]."""
        self.sent: list[tuple[float, Frame]] = []
        """Of the host, with the time."""
        self._ticks = 0
        self._devices_began = 0.0
        self._inbox: deque[Frame] = deque()

    def set_up(self, drive: Drive) -> tuple[str, ...]:
        """The drive's own set-up, before the rest: of an ODrive in simulated time, of a CiA 402
        drive, which canopen sets up, over a bus of this process in real time.
        """
        if isinstance(drive, ODrive):
            link = SimulatedLink(self.plant.devices, self._period)
            lines = drive.set_up_over(link)
            self._devices_began = math.ceil(link.now())
            return lines
        name = f"set-up {id(self)}"
        with (
            can.Bus(interface="virtual", channel=name) as theirs,
            can.ThreadSafeBus(interface="virtual", channel=name) as ours,
            PumpThread(Pump(theirs, self.plant.devices)),
        ):
            lines = drive.set_up(ours)
        self._devices_began = math.ceil(time.monotonic())
        return lines

    # Clock

    @property
    def now(self) -> float:
        return self._ticks * self._period

    @property
    def left(self) -> float:
        return self._period

    def wait(self) -> Wake:
        skipped = round(self.hang / self._period)
        self.hang = 0.0
        for _ in range(1 + skipped):
            self._advance()
        return Wake(0.0, skipped)

    # Port

    def send(self, frames: Iterable[Frame]) -> bool:
        for frame in frames:
            self.sent.append((self.now, frame))
            for arrived in self._tampered(self.tamper_host, frame):
                for device in self.plant.devices:
                    self._deliver(device.receive(arrived, self._devices_began + self.now))
        return True

    def receive(self, timeout: float) -> Frame | None:
        """Whole periods pass while it waits, if they fit."""
        for _ in range(int(timeout / self._period + 1e-9) if timeout > self._period else 0):
            if self._inbox:
                break
            self._advance()
        return self._inbox.popleft() if self._inbox else None

    def flush(self) -> None:
        self._inbox.clear()

    def close(self) -> None:
        self.closed = True

    def _advance(self) -> None:
        self.plant.advance()
        self._ticks += 1
        for device in self.plant.devices:
            self._deliver(device.advance(self._devices_began + self.now))

    def _deliver(self, frames: Iterable[Frame]) -> None:
        for frame in frames:
            self._inbox.extend(self._tampered(self.tamper, frame))

    def _tampered(self, tamper: Tampering | None, frame: Frame) -> Iterable[Frame]:
        return (frame,) if tamper is None else tamper(frame, self.now)
