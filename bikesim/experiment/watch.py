"""Watching a run: how far it is, and whether somebody wants it to end."""

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any


class Watch:
    """Asked at every tick whether to stop; shows progress on the way.

    Ctrl-C, SIGTERM and SIGHUP while `watching` end the run after the tick in progress, so
    that its record and summary are made; a second one interrupts at once.
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
        if self._left == 0 and not self._stop:
            self._left = self._every
            self._bar.update(self._every)
        return self._stop

    @contextmanager
    def watching(self) -> Iterator["Watch"]:
        """Takes the signals for as long as a run lasts."""
        before = {number: signal.signal(number, self._on_signal) for number in taken_signals()}
        try:
            yield self
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            with suppress(OSError):  # the terminal may be gone
                self._bar.close()

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        # Wrappers such as timeout(1) send the same signal twice.
        if self._stop and now - self._stopped > _ONE_SIGNAL:
            raise KeyboardInterrupt
        self._stop, self._stopped = True, now


_ONE_SIGNAL = 0.3  # [s]
_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


def taken_signals() -> tuple[signal.Signals, ...]:
    """Those that end a program; not the hangup that nohup(1) has it ignore."""
    hangup = getattr(signal, "SIGHUP", None)
    deaf = hangup is not None and signal.getsignal(hangup) is signal.SIG_IGN
    return tuple(number for number in _SIGNALS if not (deaf and number is hangup))


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
