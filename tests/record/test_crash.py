"""A kill at any moment: the file as it is after each single write opens, and lacks a block at most.

In memory and at every point here; at random points, in real processes, in test_kill.py.
"""

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from bikesim.record import layout
from bikesim.record.header import Ending
from bikesim.record.reader import Run, open_run

BLOCK = 50


class Snapshots:
    """The file as a kill after each of the writes to it would leave it."""

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch):
        self.path = path
        self.seen: list[tuple[int, bytes]] = []
        self.ticks = 0
        self._pwrite = os.pwrite
        monkeypatch.setattr(os, "pwrite", self.pwrite)

    def pwrite(self, file: int, data: memoryview, place: int) -> int:
        # In two halves, as the kernel may be interrupted inside one.
        half = len(data) // 2
        self._pwrite(file, data[:half], place)
        self.look()
        self._pwrite(file, data[half:], place + half)
        self.look()
        return len(data)

    def look(self) -> None:
        if not self.path.exists():
            return
        content = self.path.read_bytes()
        if self.seen and self.seen[-1][1] == content:
            self.seen.pop()
        self.seen.append((self.ticks, content))

    def runs(self) -> Iterator[tuple[int, Run]]:
        copy = self.path.with_name("copy.h5")
        for ticks, content in self.seen:
            copy.write_bytes(content)
            yield ticks, open_run(copy)


@pytest.mark.parametrize("planned", [110, 60], ids=["room for all", "moves to a larger file"])
def test_after_every_write_at_most_a_block_is_lacking(
    record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, planned: int
):
    snapshots = Snapshots(tmp_path / "run.h5", monkeypatch)
    with record(planned) as writer:
        for tick in range(110):
            snapshots.ticks = tick + 1
            writer.append(writer.row(tick))
    lacking = [ticks - run.ticks for ticks, run in snapshots.runs()]
    assert len(lacking) > 100
    assert min(lacking) >= 0
    assert max(lacking) <= BLOCK


def test_after_every_write_each_tick_is_whole(record, tmp_path, monkeypatch: pytest.MonkeyPatch):
    snapshots = Snapshots(tmp_path / "run.h5", monkeypatch)
    with record(60) as writer:
        writer.ride(60)
    for _, run in snapshots.runs():
        for column, name in enumerate(run.names[1:]):
            assert np.array_equal(run.channel(name), np.arange(run.ticks) + column)


def test_hdf5_has_no_part_in_writing_ticks(record):
    """Nothing changes between the start and the end but the room of the columns."""
    writer = record(500)
    before = np.fromfile(writer.path, np.uint8)
    writer.ride(400)
    changed = before != np.fromfile(writer.path, np.uint8)
    with h5py.File(writer.path) as opened:
        file: Any = opened
        for dataset in [*file["channels"].values(), *file["timing"].values()]:
            place = dataset.id.get_offset()
            changed[place : place + 8 * 500] = False
    assert not changed.any()
    writer.close()


class Journal(io.BytesIO):
    """A file in memory that keeps what each write to it left."""

    def __init__(self, content: bytes):
        super().__init__(content)
        self.states: list[bytes] = []

    def write(self, data) -> int:
        # A page of the disk is what the kernel writes at once; half of that is harsher.
        place, left = self.tell(), memoryview(data).cast("B")
        for first in range(0, len(left), 2048):
            self.seek(place + first)
            super().write(left[first : first + 2048])
            self.states.append(self.getvalue())
        return len(left)


def test_the_ending_is_written_in_place(record, tmp_path: Path):
    writer = record(100)
    writer.ride(100)
    journal = Journal(writer.path.read_bytes())
    with h5py.File(journal, "r+") as file:
        layout.write_ending(file, Ending("end of run"), np.ones(100))
    writer.close()
    assert journal.states
    assert {len(state) for state in journal.states} == {len(journal.getvalue())}
    for state in journal.states:
        (tmp_path / "copy.h5").write_bytes(state)
        assert open_run(tmp_path / "copy.h5").ticks == 100
