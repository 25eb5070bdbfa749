"""A python-can bus as the loop's port, and how it is opened."""

import select
import time
from collections.abc import Callable, Container, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from bikesim.bench.frame import Frame, from_message, to_message
from bikesim.bench.link import can_filters
from bikesim.errors import InputError, unknown
from bikesim.settings import Settings

if TYPE_CHECKING:
    import can


class BusSettings(Settings):
    """Which bus: an interface of python-can and what it must be told."""

    table: ClassVar[str] = "bus"

    interface: str = Field(
        description="Of python-can: socketcan, pcan, kvaser, slcan, udp_multicast, virtual, ..."
    )
    channel: str = Field(
        description="Of the interface: can0, PCAN_USBBUS1, /dev/ttyACM0, an address."
    )
    bitrate: Annotated[int, Field(ge=10_000, le=1_000_000)] = Field(
        default=1_000_000, description="[bit/s]; of an interface that sets it, else as it is set."
    )
    arguments: dict[str, Any] = Field(
        default={}, description="More that the interface takes, by python-can's names."
    )

    @property
    def echoes(self) -> bool:
        """Whether one receives what one sent oneself."""
        own = self.arguments.get("receive_own_messages", False)
        return self.interface == "udp_multicast" or bool(own)

    def __str__(self) -> str:
        return f"bus {self.interface} {self.channel}"


# These have no bit rate, or it is set outside; python-can warns of a key that it does not know.
_FLUSH = 0.2  # s, at most
_WITHOUT_BITRATE = ("virtual", "udp_multicast", "socketcan")


def open_bus(settings: BusSettings) -> "can.ThreadSafeBus":
    """The bus, without a filter. Raises InputError."""
    import can
    from can.interfaces import VALID_INTERFACES

    if settings.interface not in VALID_INTERFACES:
        raise unknown("bus.interface", settings.interface, sorted(VALID_INTERFACES))
    arguments: dict[str, Any] = dict(settings.arguments)
    if settings.interface not in _WITHOUT_BITRATE:
        arguments["bitrate"] = settings.bitrate
    try:
        with _quiet():
            return can.ThreadSafeBus(
                interface=settings.interface, channel=settings.channel, **arguments
            )
    except Exception as error:  # each interface raises its own
        raise InputError(f"{settings}: cannot be opened: {told(error)}") from None


def filter_for(bus: "can.BusABC", ids: Iterable[int] | None) -> None:
    """Only frames with these ids are received from now on; None: all.

    Not in the loop: where python-can filters itself, a `recv(0)` that meets a frame which is not
    wanted says that there is none, however many are behind it.
    """
    bus.set_filters(None if ids is None else can_filters(ids))


@contextmanager
def _quiet() -> Iterator[None]:
    """Without what python-can logs beside the exception that it raises."""
    import logging

    log = logging.getLogger("can")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(level)


class BusPort:
    """The loop's port: frames of `ids` are received, others passed over; see `Port`.

    What is sent and received is handed to `log` too, if there is one. It belongs to one thread.
    """

    def __init__(
        self,
        bus: "can.BusABC",
        ids: Container[int],
        log: "Callable[[can.Message], object] | None" = None,
    ) -> None:
        import can

        # Without the locks of a bus that many threads share.
        self._bus: can.BusABC = getattr(bus, "__wrapped__", bus)
        self._ids, self._log = ids, log
        self._waiting = _poll(self._bus)
        self._error_of: tuple[type[Exception], ...] = (can.CanError, OSError)
        self.trouble = ""

    def send(self, frames: Iterable[Frame]) -> None:
        """Until one cannot be sent; `trouble` says so."""
        for frame in frames:
            message = to_message(frame)
            try:
                self._bus.send(message)
            except self._error_of as error:
                self.trouble = f"cannot send: {told(error)}"
                return
            if self._log is not None:
                message.timestamp = time.time()
                message.is_rx = False
                self._log(message)

    def receive(self, timeout: float) -> Frame | None:
        """The next frame; None if there is none within `timeout` [s], or the bus is in trouble."""
        if timeout == 0.0 and self._waiting is not None and not self._waiting(0):
            return None  # asked of the system alone, in a tenth of the time
        deadline = time.perf_counter() + timeout
        left = timeout
        while (message := self._next(left)) is not None:
            frame = self._taken(message)
            if frame is not None:
                return frame
            left = max(deadline - time.perf_counter(), 0.0)
        return None

    def flush(self) -> None:
        """Forgets what came up to now; a flood is not waited for."""
        end = time.perf_counter() + _FLUSH
        while time.perf_counter() < end and self._next(0.0) is not None:
            pass

    def close(self) -> None:
        """Once is enough."""
        self._bus.shutdown()

    def _next(self, timeout: float) -> "can.Message | None":
        try:
            return self._bus.recv(timeout)
        except self._error_of as error:
            self.trouble = f"cannot receive: {told(error)}"
            return None

    def _taken(self, message: "can.Message") -> Frame | None:
        if message.is_error_frame:
            self.trouble = "error frames: wiring, termination, or a wrong bit rate"
        elif message.arbitration_id in self._ids:
            if self._log is not None:
                self._log(message)
            return from_message(message)
        return None


def _poll(bus: "can.BusABC") -> Callable[[int], object] | None:
    """What says whether something waits to be read, where the bus is a file for the system."""
    try:
        number = bus.fileno()
    except NotImplementedError:
        return None
    if number < 0 or not hasattr(select, "poll"):
        return None
    poll = select.poll()
    poll.register(number, select.POLLIN | select.POLLERR | select.POLLHUP)
    return poll.poll


def told(error: Exception) -> str:
    """What an exception says, in one line."""
    cause = error.__cause__ if isinstance(error.__cause__, OSError) else None
    said = " ".join(str(error).split()) or type(error).__name__
    return f"{said}: {cause.strerror}" if cause is not None and cause.strerror else said


def bus_load(frames: Iterable[tuple[int, float]], bitrate: int) -> float:
    """The share of a bus that frames take, at worst.

    `frames`: bytes of data, and how often a second [1/s], of each. A frame of n bytes with an
    11-bit identifier has at most 8n + 44 + (34 + 8n - 1)//4 bits, stuff bits included, and three
    between it and the next [Davis et al. 2007, "Controller Area Network (CAN) schedulability
    analysis", eq. 4].
    """
    return sum(rate * worst_bits(size) for size, rate in frames) / bitrate


def worst_bits(size: int) -> int:
    """Of a frame with so many data bytes: the longest that it can be, with its pause."""
    return 8 * size + 47 + (34 + 8 * size - 1) // 4
