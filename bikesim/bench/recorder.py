"""The record of a ride, written on a thread of its own, and the raw frames beside it."""

import contextlib
import os
import threading
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Self

from bikesim.bench.faults import Fault, Observation, Reaction
from bikesim.errors import InputError
from bikesim.model.real import Real
from bikesim.realtime import PRIORITY
from bikesim.record.header import Ending
from bikesim.record.writer import RunWriter

if TYPE_CHECKING:
    import can

_TICKS = 10  # between two looks at what there is to write
_PAUSE = 0.05  # s, at most; where there are no ticks
_AT_ONCE = 50  # rows or frames, before the tick's thread is let in
_MOST_WAITING = 5.0  # s of ticks, of which a disk that hangs takes none
_PATIENCE = 2.0  # s, from one word of it to the next
_ROW = 27


class ThreadedRecorder:
    """Takes a tick's row, and the bus's frames, at the cost of an append; a thread writes both.

    What cannot be written is said in `trouble`, once, and never raised into a tick. What was
    written before is kept.
    """

    def __init__(
        self,
        writer: RunWriter,
        frames: Path | None = None,
        say: Callable[[str], object] = lambda line: None,
    ) -> None:
        """`say` is told when the end has to wait for a disk."""
        self._say = say
        self._writer, self._path = writer, frames
        self._rows: deque[tuple[Real, ...]] = deque()
        self._frames: deque[tuple[can.Message, float | None]] = deque()
        self.trouble = ""
        self._done = False
        self._wake = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def append(self, row: tuple[Real, ...]) -> None:
        """A tick's."""
        self._rows.append(row)
        if len(self._rows) >= _TICKS and not self._wake.is_set():
            # Now is the time: the loop has nothing to do until the next tick.
            self._wake.set()

    def log(self, message: "can.Message", sent: float | None = None) -> None:
        """A frame, and when it was sent [s since 1970]; None: it was received."""
        self._frames.append((message, sent))

    def stop(self) -> None:
        """Writes what is left. Once is enough.

        Ctrl-C ends that where a disk hangs: the record is then left as it is, as a kill leaves it.
        """
        self._done = True
        self._wake.set()
        try:
            self._thread.join(_PATIENCE)
            while self._thread.is_alive():
                self._say(
                    f"waiting  for the disk: {len(self._rows)} ticks are not written yet (Ctrl-C: "
                    "they are lost)"
                )
                self._thread.join(_PATIENCE)
        except KeyboardInterrupt:
            # Its thread may be in the middle of a write.
            self._writer.abandon()
            raise

    def finish(self, ending: Ending) -> None:
        """Stops, and says why the ride ended. Raises InputError if the record is not whole."""
        self.stop()
        self._writer.finish(ending)
        if self.trouble:
            raise InputError(self.trouble)

    def failed(self, o: Observation) -> Fault | None:
        """A monitor: nobody should ride on without a record."""
        if self.trouble:
            return Fault(_ROW, f"recording: {self.trouble}", "a record", Reaction.RAMP)
        try:
            waits = o.time - self._rows[0][0]
        except IndexError:  # all is written, by now at least
            return None
        if not waits > _MOST_WAITING:
            return None
        what = f"recording: {waits:.1f} s of ticks wait to be written"
        return Fault(_ROW, what, f"{_MOST_WAITING:g} s", Reaction.RAMP)

    def _run(self) -> None:
        _stand_back()
        try:
            if self._path is None:
                self._write_until_done(None)
                return
            from can.io.blf import BLFWriter

            with BLFWriter(self._path) as log:
                self._write_until_done(log)
        except InputError as error:
            self.trouble = str(error)
        except Exception as error:  # whatever it is, the ride must hear of it
            self.trouble = f"{type(error).__name__}: {error}"

    def _write_until_done(self, log) -> None:
        while True:
            done = self._done
            while self._write_some(log):
                # Others may have waited for this interpreter.
                time.sleep(0)
            if done:
                return
            self._wake.wait(_PAUSE)
            self._wake.clear()

    def _write_some(self, log) -> bool:
        rows, frames = self._rows, self._frames
        for _ in range(min(_AT_ONCE, len(rows))):
            self._writer.append(rows.popleft())
        for _ in range(min(_AT_ONCE, len(frames))):
            message, sent = frames.popleft()
            if sent is not None:
                message.timestamp, message.is_rx = sent, False
            if log is not None:
                log.on_message_received(message)
        return bool(rows or frames)


def _stand_back() -> None:
    """Behind the loop, where both are under real-time scheduling.

    Before all others all the same: while it holds the interpreter the loop waits for it.
    """
    with contextlib.suppress(OSError, AttributeError):
        if os.sched_getscheduler(0) == os.SCHED_FIFO:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY - 1))
