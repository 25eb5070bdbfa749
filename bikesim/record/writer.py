"""Writing a run while it runs, so that a kill at any moment costs less than a second of it."""

import contextlib
import struct
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py
import numpy as np

from bikesim.errors import InputError
from bikesim.record.channels import TIMING_CHANNELS, Channel
from bikesim.record.columns import Columns
from bikesim.record.header import Ending, RunHeader
from bikesim.record.layout import Layout, write_ending
from bikesim.record.output import output_path, put_in_place, unwritable
from bikesim.record.provenance import Provenance

__all__ = ["Ending", "Provenance", "RunHeader", "RunWriter"]

BLOCK = 0.5  # [s] written at once: of the run's time and of the wall's
UNPLANNED = 600.0  # [s] of room for a run without a planned end
MOST_AT_ONCE = 3600.0  # [s] of room for a run that is planned longer


class RunWriter:
    """Writes one run to one file; a context manager.

    A row is one value a channel, in their order, then one for each of TIMING_CHANNELS. The room
    for `planned_ticks` is taken at the start; a run that goes on longer moves to a larger file.
    Raises InputError, also from `append`, when the file cannot be written; the ticks written
    before are kept.
    """

    __slots__ = (
        "_buffer", "_closed", "_columns", "_due", "_ending", "_full", "_layout", "_pack",
        "_row_bytes", "_width", "_written", "path",
    )  # fmt: skip

    def __init__(
        self,
        path: Path,
        *,
        channels: Sequence[Channel],
        period: float,
        planned_ticks: int | None,
        header: RunHeader,
        force: bool = False,
    ):
        self._layout = Layout(tuple(channels), period, header)
        self.path = output_path(path, force=force)
        self._width = len(self._layout.columns)
        row = struct.Struct(f"{self._width}d")
        self._pack = row.pack
        self._row_bytes = row.size
        self._full = row.size * _ticks(BLOCK, period)
        self._buffer = bytearray()
        self._due = BLOCK
        self._written = 0
        self._ending: Ending | None = None
        self._closed = False
        planned = _ticks(UNPLANNED, period) if planned_ticks is None else max(1, planned_ticks)
        try:
            self._columns = self._lay_out(min(planned, _ticks(MOST_AT_ONCE, period)), None)
        except (OSError, RuntimeError) as error:
            raise unwritable(self.path, error) from error

    @property
    def ticks(self) -> int:
        """Rows appended so far."""
        return self._written + self._pending

    def append(self, row: tuple[float, ...]) -> None:
        """One tick. Costs a copy of the row; every half second also the write of a block."""
        buffer = self._buffer
        buffer += self._pack(*row)
        if len(buffer) >= self._full or row[_WALL_TIME] >= self._due:
            self._due = row[_WALL_TIME] + BLOCK
            self._flush()

    def finish(self, ending: Ending) -> None:
        """Say why the run ended; `close` writes it."""
        self._ending = ending

    def close(self) -> None:
        """Write what is left and the ending, and give back the room not used. Once is enough."""
        if self._closed:
            return
        self._closed = True
        try:
            self._flush()
        finally:
            self._end()

    def abandon(self) -> None:
        """Nothing is written any more; what was is kept, and opens as after a kill."""
        self._closed = True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None and self._ending is None:
            self.finish(_cut_short(error))
        try:
            self.close()
        except InputError as second:
            if error is None:
                raise
            if str(second) != str(error):
                error.add_note(str(second))

    @property
    def _pending(self) -> int:
        return len(self._buffer) // self._row_bytes

    def _flush(self) -> None:
        room = self._columns.capacity - self._written
        try:
            if self._pending > room:
                self._store(room)
                self._move(max(2 * self._columns.capacity, self._written + self._pending))
            self._store(self._pending)
        except (OSError, RuntimeError) as error:
            raise unwritable(self.path, error, self._kept) from error

    @property
    def _kept(self) -> str:
        seconds = self._written * self._layout.period
        return f"; the {self._written} ticks before ({seconds:g} s) are kept"

    def _store(self, ticks: int) -> None:
        """Write the oldest rows of the buffer, and keep the others."""
        if ticks == 0:
            return
        rows = np.frombuffer(self._buffer, count=ticks * self._width).reshape(ticks, self._width)
        self._columns.write(self._written, np.ascontiguousarray(rows.T))
        del rows  # a buffer that is looked at cannot shrink
        self._written += ticks
        del self._buffer[: ticks * self._row_bytes]

    def _lay_out(self, capacity: int, old: Columns | None) -> Columns:
        """A file with room for `capacity` ticks and those of `old`, put in place in one step."""
        with contextlib.ExitStack() as undo:
            with put_in_place(self.path, durable=old is not None) as part:
                columns = undo.enter_context(Columns(part, self._layout, capacity))
                if old is not None:
                    columns.copy(old, self._written)
                columns.fill(self._written)
            undo.pop_all()
        return columns

    def _move(self, capacity: int) -> None:
        old = self._columns
        self._columns = self._lay_out(capacity, old)
        old.close()

    def _end(self) -> None:
        try:
            compute_time = self._columns.read(_COMPUTE_TIME, 0, self._written)
            if self._written < self._columns.capacity:
                # Without room for the smaller copy the record is whole as it is, NaN at its end.
                with contextlib.suppress(OSError, RuntimeError):
                    self._move(self._written)
            self._columns.close()
            with h5py.File(self.path, "r+", locking=False) as file:
                write_ending(file, self._ending or _UNSAID, compute_time)
        except (OSError, RuntimeError) as error:  # h5py raises either
            raise unwritable(self.path, error, self._kept) from error


# Counted from the end of a row, where the timing stands.
_WALL_TIME, _COMPUTE_TIME = (
    [channel.name for channel in TIMING_CHANNELS].index(name) - len(TIMING_CHANNELS)
    for name in ("wall_time", "compute_time")
)
_UNSAID = Ending("closed")


def _ticks(seconds: float, period: float) -> int:
    return max(1, int(seconds / period + 1e-9))


def _cut_short(error: BaseException) -> Ending:
    if isinstance(error, KeyboardInterrupt):
        return Ending("interrupted")
    return Ending(f"fault: {error or type(error).__name__}")
