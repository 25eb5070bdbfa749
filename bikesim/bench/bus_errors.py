"""A bus that fails, as one line for a person: python-can raises what no command expects."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from bikesim.errors import InputError

if TYPE_CHECKING:
    import can

_PAUSE = 0.02  # s, of a thread that would else ask a broken bus without end


def told(error: Exception) -> str:
    """What an exception says, in one line."""
    cause = error.__cause__ if isinstance(error.__cause__, OSError) else None
    said = " ".join(str(error).split()) or type(error).__name__
    return f"{said}: {cause.strerror}" if cause is not None and cause.strerror else said


@contextmanager
def bus_fails() -> Iterator[None]:
    """What python-can raises inside becomes an InputError."""
    import can

    try:
        yield
    except (can.CanError, OSError) as error:
        raise InputError(f"the bus fails: {told(error)}") from None


def received(bus: "can.BusABC", timeout: float) -> "can.Message | None":
    """The next message; None if there is none within `timeout` [s]. Raises InputError."""
    with bus_fails():
        return bus.recv(timeout)


class Unreadable:
    """A listener that hears why a bus cannot be read; without one the thread ends by a traceback.

    `error` is what was raised last.
    """

    def __init__(self) -> None:
        self.error: Exception | None = None

    def __call__(self, message: "can.Message") -> None:
        """Frames are for others."""

    def on_error(self, error: Exception) -> None:
        """Called by a notifier."""
        self.error = error
        time.sleep(_PAUSE)
