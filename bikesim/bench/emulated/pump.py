"""Puts emulated devices on a python-can bus, in real time."""

import threading
import time
from collections.abc import Iterable
from types import TracebackType
from typing import TYPE_CHECKING, Self

from bikesim.bench.emulated.device import Device
from bikesim.bench.frame import Frame, from_message, to_message

if TYPE_CHECKING:
    import can

_SHORTEST = 0.0005  # s, that is waited for a frame


class Pump:
    """Between a bus and devices that share it. The bus stays its owner's."""

    def __init__(self, bus: "can.BusABC", devices: Iterable[Device]) -> None:
        self._bus, self._devices = bus, tuple(devices)

    def once(self) -> None:
        """Takes what came, for at most half a millisecond, and sends what is due."""
        message = self._bus.recv(_SHORTEST)
        while message is not None:
            frame = from_message(message)
            if frame is not None:
                self._deliver(frame)
            message = self._bus.recv(0)
        now = time.monotonic()
        for device in self._devices:
            self._send(device.advance(now))

    def _deliver(self, frame: Frame) -> None:
        now = time.monotonic()
        for device in self._devices:
            self._send(device.receive(frame, now))

    def _send(self, frames: Iterable[Frame]) -> None:
        for frame in frames:
            self._bus.send(to_message(frame))


class PumpThread:
    """A pump that runs while it is a context; what went wrong in it is raised at its end."""

    def __init__(self, pump: Pump) -> None:
        self._pump = pump
        self._stop = threading.Event()
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="emulated devices", daemon=True)

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                self._pump.once()
        except Exception as error:
            self._error = error

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop.set()
        self._thread.join()
        if self._error is not None and error is None:
            raise self._error
