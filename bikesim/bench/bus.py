"""A python-can bus as the loop's port, and how it is opened."""

import os
import select
import stat
import time
from collections.abc import Callable, Container, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from bikesim.bench.bus_errors import bus_fails, told
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


# How much later than asked for a wait for frames may end [s]: the system's own is exact, that of an
# interface may go by milliseconds or poll.
_PROMPT, _LATE = 80e-6, 200e-6

# These have no bit rate, or it is set outside; python-can warns of a key that it does not know.
_FLUSH = 0.2  # s, at most
_WITHOUT_BITRATE = ("virtual", "udp_multicast", "socketcan")


def open_bus(settings: BusSettings) -> "can.BusABC":
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
            if settings.interface == "slcan":
                from bikesim.bench.slcan import SlcanBus

                return SlcanBus(settings.channel, **arguments)
            return can.ThreadSafeBus(
                interface=settings.interface, channel=settings.channel, **arguments
            )
    except Exception as error:  # each interface raises its own
        raise InputError(f"{settings}: cannot be opened: {told(error)}") from None


def close_bus(bus: "can.BusABC") -> None:
    """Whether it is open, closed already, or gone."""
    import can

    with suppress(can.CanError, OSError):
        bus.shutdown()


def filter_for(bus: "can.BusABC", ids: Iterable[int] | None) -> None:
    """Only frames with these ids are received from now on; None: all. Raises InputError.

    Not in the loop: where python-can filters itself, a `recv(0)` that meets a frame which is not
    wanted says that there is none, however many are behind it.
    """
    with bus_fails():
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

    All that is sent and received, of others and error frames too, is handed to `log`, if there is
    one; it must not keep the loop, nor change the message. It belongs to one thread.
    """

    def __init__(
        self,
        bus: "can.BusABC",
        ids: Container[int],
        log: "Callable[[can.Message, float | None], object] | None" = None,
        echoed: Iterable[int] = (),
    ) -> None:
        """`log` takes a message, and when it was sent [s since 1970]; None: it was received.

        Frames of `echoed` come back from the bus: as many as were sent of each are passed over.
        """
        import can

        # Without the locks of a bus that many threads share.
        self._bus: can.BusABC = getattr(bus, "__wrapped__", bus)
        self._ids, self._log = ids, log
        self._own = dict.fromkeys(echoed, 0)
        """How many have been sent that have not come back."""
        self._wait = _waiting(self._bus)
        self.wakes_late = _LATE if self._wait is None else _PROMPT
        # ValueError: of a socket that is closed.
        self._error_of: tuple[type[Exception], ...] = (can.CanError, OSError, ValueError)
        self.trouble = ""
        self._deaf = False

    def send(self, frames: Iterable[Frame]) -> bool:
        """Until one cannot be sent; `trouble` says so."""
        for frame in frames:
            message = to_message(frame)
            try:
                self._bus.send(message)
            except self._error_of as error:
                self.trouble = f"cannot send: {told(error)}"
                return False
            if frame.id in self._own:
                self._own[frame.id] += 1
            if self._log is not None:
                self._log(message, time.time())
        return True

    def receive(self, timeout: float) -> Frame | None:
        """The next frame; None if there is none within `timeout` [s], or the bus is in trouble."""
        wait = self._wait
        if wait is None:
            return self._receive(timeout)
        try:
            if timeout <= 0.0:
                # The system is asked, which takes a tenth of the time that the bus would.
                return self._receive(0.0) if wait(0.0) else None
            return self._waited_for(timeout, wait)
        except self._error_of as error:
            self.trouble, self._deaf = f"cannot receive: {told(error)}", True
            return None

    def _waited_for(self, timeout: float, wait: Callable[[float], object]) -> Frame | None:
        deadline = time.perf_counter() + timeout
        while wait(max(timeout, 0.0)):
            frame = self._receive(0.0)
            if frame is not None or self._deaf:
                return frame
            timeout = deadline - time.perf_counter()
        return None

    def _receive(self, timeout: float) -> Frame | None:
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
        self._own = dict.fromkeys(self._own, 0)

    def close(self) -> None:
        """Once is enough."""
        close_bus(self._bus)

    def _next(self, timeout: float) -> "can.Message | None":
        try:
            return self._bus.recv(timeout)
        except self._error_of as error:
            self.trouble, self._deaf = f"cannot receive: {told(error)}", True
            return None

    def _taken(self, message: "can.Message") -> Frame | None:
        identifier = message.arbitration_id
        if not message.is_error_frame and self._came_back(identifier):
            return None
        if self._log is not None:
            self._log(message, None)
        if message.is_error_frame:
            self.trouble = "error frames: wiring, termination, or a wrong bit rate"
            return None
        return from_message(message) if identifier in self._ids else None

    def _came_back(self, identifier: int) -> bool:
        """Whether it is this port's own. One that the bus lost lets one of another pass for it."""
        outstanding = self._own.get(identifier, 0)
        if outstanding:
            self._own[identifier] = outstanding - 1
        return outstanding > 0


def _waiting(bus: "can.BusABC") -> Callable[[float], object] | None:
    """What waits for so long [s] for something to read, where the bus is a socket.

    Of a serial line something may have been read already that nobody has taken yet.
    """
    try:
        number = bus.fileno()
    except NotImplementedError:
        return None
    if number < 0 or not stat.S_ISSOCK(os.fstat(number).st_mode) or not hasattr(select, "poll"):
        return None
    poll = select.poll()
    poll.register(number, select.POLLIN | select.POLLERR | select.POLLHUP)
    look, sources = poll.poll, (number,)

    def wait(timeout: float) -> object:
        # poll() is quicker to ask, but waits for whole milliseconds; select() for microseconds.
        if timeout <= 0.0:
            return look(0)
        return select.select(sources, (), (), timeout)[0]

    return wait


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
