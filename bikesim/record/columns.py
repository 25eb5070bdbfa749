"""The ticks of a run file, written by their place in it: HDF5 has no part in it."""

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bikesim.record.layout import Layout
from bikesim.record.output import hold

_PIECE = 1 << 20  # ticks that are filled or copied at once


class Columns:
    """The columns of a new run file with room for `capacity` ticks. All of it raises OSError."""

    def __init__(self, path: Path, layout: Layout, capacity: int):
        self.capacity = capacity
        self._places = layout.create(path, capacity)
        # The time goes last: a row whose time is there is there in every column.
        time = layout.columns.index("channels/time")
        self._order = [column for column in range(len(self._places)) if column != time] + [time]
        self._file = path.open("r+b", buffering=0)
        hold(self._file.fileno())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let the file go."""
        self._file.close()

    def fill(self, first: int = 0) -> None:
        """NaN from a tick on: what was never written shows, and the disk's room is ours."""
        for column in range(len(self._places)):
            for piece, ticks in _pieces(first, self.capacity):
                self._write(column, piece, np.full(ticks, math.nan))

    def write(self, first: int, block: NDArray[np.float64]) -> None:
        """Rows of ticks from `first` on; `block` has a row a column."""
        for column in self._order:
            self._write(column, first, block[column])

    def read(self, column: int, first: int, ticks: int) -> NDArray[np.float64]:
        """A piece of one column."""
        place = self._places[column] + 8 * first
        return np.frombuffer(os.pread(self._file.fileno(), 8 * ticks, place), "<f8")

    def copy(self, other: "Columns", ticks: int) -> None:
        """Take over the first `ticks` ticks of another file of the same layout."""
        for column in self._order:
            for first, size in _pieces(0, ticks):
                self._write(column, first, other.read(column, first, size))

    def _write(self, column: int, first: int, values: NDArray[np.float64]) -> None:
        left = memoryview(values.astype("<f8", copy=False).data).cast("B")
        place = self._places[column] + 8 * first
        while left:  # a disk that fills takes a part, and refuses only the next
            written = os.pwrite(self._file.fileno(), left, place)
            left, place = left[written:], place + written


def _pieces(first: int, last: int) -> Iterator[tuple[int, int]]:
    """Start and size of the pieces from `first` to before `last`."""
    for start in range(first, last, _PIECE):
        yield start, min(_PIECE, last - start)
