"""Watching a run: how far it is, and whether somebody wants it to end."""

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any


class Watch:
    """Asked at every tick whether to stop; shows progress on the way.

    Ctrl-C and SIGTERM while `watching` end the run after the tick in progress, so that its record
    and summary are made; a second one interrupts at once.
    """

    def __init__(
        self, ticks: int, period: float, *, unit: str = "tick", show: bool | None = None
    ) -> None:
        """Progress in a `unit` is shown on a terminal's stderr; `show` says otherwise."""
        self._every = max(1, round(0.25 / period))
        self._left = self._every
        self._stop, self._stopped = False, 0.0
        self._bar = _bar(ticks, period, unit, show)

    def __call__(self) -> bool:
        """Whether to stop now."""
        self._left -= 1
        if self._left == 0:
            self._left = self._every
            self._bar.update(self._every)
        return self._stop

    @contextmanager
    def watching(self) -> Iterator["Watch"]:
        """Takes the signals for as long as a run lasts."""
        before = {number: signal.signal(number, self._on_signal) for number in _SIGNALS}
        try:
            yield self
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            self._bar.close()

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        # Wrappers such as timeout(1) send the same signal twice.
        if self._stop and now - self._stopped > _ONE_SIGNAL:
            raise KeyboardInterrupt
        self._stop, self._stopped = True, now


_ONE_SIGNAL = 0.3  # [s]
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def _bar(ticks: int, period: float, unit: str, show: bool | None) -> Any:
    from tqdm import tqdm

    return tqdm(
        total=ticks,
        unit=unit,
        unit_scale=True,
        desc=f"{ticks * period:g} s",
        leave=False,
        disable=not (sys.stderr.isatty() if show is None else show),
        file=sys.stderr,
    )
