"""A link to emulated devices in simulated time: a second passes at once, and always the same."""

from collections import deque
from collections.abc import Iterable

from bikesim.bench.emulated.device import Device
from bikesim.bench.frame import Frame


class SimulatedLink:
    """Devices on an ideal bus: a frame arrives when it is sent. `step` [s] of the time."""

    def __init__(self, devices: Iterable[Device], step: float = 0.001) -> None:
        self._devices, self._step = tuple(devices), step
        self._steps = 0
        self._inbox: deque[Frame] = deque()

    def now(self) -> float:
        return self._steps * self._step

    def send(self, frame: Frame) -> None:
        for device in self._devices:
            self._inbox += device.receive(frame, self.now())

    def receive(self, timeout: float) -> Frame | None:
        end = self.now() + timeout
        while not self._inbox and self.now() < end:
            self._steps += 1
            for device in self._devices:
                self._inbox += device.advance(self.now())
        return self._inbox.popleft() if self._inbox else None
