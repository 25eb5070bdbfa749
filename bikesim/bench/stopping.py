"""Ctrl-C and its like during a ride: the first lets the torque ramp out, the second does not."""

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from bikesim.experiment.watch import taken_signals

_ONE_SIGNAL = 0.3  # [s]: wrappers such as timeout(1) send the same signal twice


class Stopping:
    """Asked at every tick whether to stop at once."""

    def __init__(self, ask: Callable[[str], object]) -> None:
        """`ask` is told why, by the first signal."""
        self._ask = ask
        self._first: float | None = None
        self._at_once = False

    def __call__(self) -> bool:
        return self._at_once

    @property
    def asked(self) -> bool:
        """Whether anybody wanted it to stop."""
        return self._first is not None

    @contextmanager
    def watching(self) -> Iterator["Stopping"]:
        """Takes the signals for as long as a ride lasts."""
        before = {number: signal.signal(number, self.on_signal) for number in taken_signals()}
        try:
            yield self
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def on_signal(self, number: int, frame: FrameType | None) -> None:
        """The handler."""
        del number, frame
        now = time.monotonic()
        if self._first is None:
            self._first = now
            self._ask("interrupted")
        elif now - self._first > _ONE_SIGNAL:
            self._at_once = True
