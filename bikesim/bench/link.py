"""How a set-up talks to a device: frames out, frames in, and the time, real or simulated."""

import time
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Protocol

from bikesim.bench.bus_errors import bus_fails, received
from bikesim.bench.frame import Frame, from_message, to_message

if TYPE_CHECKING:
    import can
    from can.typechecking import CanFilter


class Link(Protocol):
    """The bus as a set-up sees it; not for the loop, which must not wait."""

    def now(self) -> float:
        """Time [s] from an arbitrary start."""
        ...

    def send(self, frame: Frame) -> None: ...

    def receive(self, timeout: float) -> Frame | None:
        """The next frame; None if there is none within `timeout` [s]."""
        ...


class BusLink:
    """A link on a python-can bus, in real time. The bus stays its owner's.

    Raises InputError where the bus fails.
    """

    def __init__(self, bus: "can.BusABC") -> None:
        self._bus = bus

    def now(self) -> float:
        return time.monotonic()

    def send(self, frame: Frame) -> None:
        with bus_fails():
            self._bus.send(to_message(frame))

    def receive(self, timeout: float) -> Frame | None:
        deadline = time.monotonic() + timeout
        while True:
            message = received(self._bus, max(deadline - time.monotonic(), 0.0))
            if message is None:
                return None
            frame = from_message(message)
            if frame is not None:
                return frame


def until(link: Link, deadline: float) -> Iterator[Frame]:
    """The frames that come until `deadline` on the link's clock [s]."""
    while (left := deadline - link.now()) > 0:
        frame = link.receive(left)
        if frame is not None:
            yield frame


def can_filters(ids: Iterable[int]) -> "list[CanFilter]":
    """python-can's filters for these identifiers alone.

    Each side of a bus that echoes (udp_multicast gives back what one sent) filters for what the
    other side sends; else its own commands come back as if there were a second master.
    """
    return [{"can_id": one, "can_mask": 0x7FF, "extended": False} for one in sorted(set(ids))]
