import threading
import time
from pathlib import Path
from typing import Any

import can
import pytest

from bikesim import bicycles
from bikesim.bench import recorder as recorder_module
from bikesim.bench.faults import Observation, Reaction
from bikesim.bench.recorder import ThreadedRecorder
from bikesim.bench.rig import BENCH_CHANNELS
from bikesim.errors import InputError
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending, RunHeader
from bikesim.record.provenance import Provenance
from bikesim.record.reader import open_run
from bikesim.record.writer import RunWriter

from .observed import SOUND

HEADER = RunHeader(
    scenario="", bicycle=bicycles.load("benchmark"), law="paper", handlebar_inertia=0.2,
    rig="bench", rider="person", seed=1, provenance=Provenance.gather(),
)  # fmt: skip
ROW = tuple(0.0 for _ in (*TICK_CHANNELS, *BENCH_CHANNELS)) + (0.0, 0.0)


def writer(path: Path, ticks: int = 3000) -> RunWriter:
    return RunWriter(
        path,
        channels=(*TICK_CHANNELS, *BENCH_CHANNELS),
        period=0.001,
        planned_ticks=ticks,
        header=HEADER,
    )


def at(time: float) -> Observation:
    """Of a monitor that looks at nothing but the time [s]."""
    return SOUND._replace(time=time)


def row(tick: int) -> tuple[float, ...]:
    return (tick * 0.001, *ROW[1:])


def test_rows_and_frames_are_written_on_another_thread(tmp_path: Path):
    with writer(tmp_path / "run.h5") as record:
        with ThreadedRecorder(record, tmp_path / "run.blf") as recorder:
            for tick in range(3000):
                recorder.append(row(tick))
                recorder.log(can.Message(arbitration_id=tick % 2000, is_extended_id=False))
            recorder.log(can.Message(is_error_frame=True))
        recorder.finish(Ending("end of run"))
    run = open_run(tmp_path / "run.h5")
    assert run.ticks == 3000
    assert run.time[-1] == pytest.approx(2.999)
    assert run.ending == Ending("end of run")
    *frames, error = can.BLFReader(tmp_path / "run.blf")
    assert error.is_error_frame
    assert [one.arbitration_id for one in frames] == [tick % 2000 for tick in range(3000)]


def test_what_is_left_at_the_end_is_written_to_the_last(tmp_path: Path):
    """However many there are: not the tens of them alone that are written at once."""
    with writer(tmp_path / "run.h5") as record:
        recorder = ThreadedRecorder(record, tmp_path / "run.blf")
        for tick in range(99):
            recorder.append(row(tick))
        recorder.log(can.Message(arbitration_id=1, is_extended_id=False))
        recorder._done = True  # stopped, before its thread has looked
        with recorder:
            pass
        recorder.finish(Ending("end of run"))
    assert open_run(tmp_path / "run.h5").ticks == 99
    assert len(list(can.BLFReader(tmp_path / "run.blf"))) == 1


class FullDisk:
    """A writer whose disk is full from the 100th row on."""

    def __init__(self, record: RunWriter) -> None:
        self._record, self._left = record, 100

    def append(self, one: tuple[float, ...]) -> None:
        if self._left == 0:
            raise InputError("run.h5: cannot be written: no space left on device")
        self._left -= 1
        self._record.append(one)

    def finish(self, ending: Ending) -> None:
        self._record.finish(ending)


class HangingDisk:
    """A writer whose disk takes nothing until it goes on."""

    def __init__(self, record: RunWriter, hangs: threading.Event, goes_on: threading.Event) -> None:
        self._record, self._hangs, self._goes_on = record, hangs, goes_on

    def append(self, one: tuple[float, ...]) -> None:
        self._hangs.set()
        self._goes_on.wait(30)
        self._record.append(one)

    def finish(self, ending: Ending) -> None:
        self._record.finish(ending)

    def abandon(self) -> None:
        self._record.abandon()


def test_a_full_disk_is_a_fault_that_ramps_out_and_what_is_written_is_kept(tmp_path: Path):
    full: Any = FullDisk(record := writer(tmp_path / "run.h5"))
    observation = at(0.0)
    with record:
        with ThreadedRecorder(full) as recorder:
            assert recorder.failed(observation) is None
            for tick in range(500):
                recorder.append(row(tick))
            deadline = time.monotonic() + 5
            while recorder.failed(observation) is None and time.monotonic() < deadline:
                time.sleep(0.01)
            fault = recorder.failed(observation)
            assert fault is not None
            assert fault.reaction is Reaction.RAMP
            assert "no space left on device" in str(fault)
            recorder.append(row(500))  # raises nothing
        with pytest.raises(InputError, match="no space left"):
            recorder.finish(Ending("fault"))
    assert open_run(tmp_path / "run.h5").ticks == 100


def test_a_disk_that_hangs_is_a_fault_and_nothing_is_lost(tmp_path: Path):
    hangs, goes_on = threading.Event(), threading.Event()
    with writer(tmp_path / "run.h5", 6000) as record:
        disk: Any = HangingDisk(record, hangs, goes_on)
        with ThreadedRecorder(disk) as recorder:
            for tick in range(50):
                recorder.append(row(tick))
            assert hangs.wait(30)
            for tick in range(50, 6000):
                recorder.append(row(tick))
            # The thread has taken the oldest; the next one is that which waits longest.
            assert recorder.failed(at(5.0)) is None
            fault = recorder.failed(at(5.3))
            assert fault is not None
            assert (fault.row, fault.reaction) == (27, Reaction.RAMP)
            assert "s of ticks wait to be written; allowed 5 s" in str(fault)
            goes_on.set()
        assert recorder.failed(at(6.0)) is None
        recorder.finish(Ending("end of run"))
    assert open_run(tmp_path / "run.h5").ticks == 6000


def test_ctrl_c_while_a_disk_hangs_keeps_what_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    hangs, goes_on = threading.Event(), threading.Event()
    said: list[str] = []

    def tell(line: str) -> None:
        said.append(line)
        raise KeyboardInterrupt  # as whoever reads it does

    def ridden() -> None:
        with writer(tmp_path / "run.h5") as record:
            for tick in range(1200):
                record.append(row(tick))
            disk: Any = HangingDisk(record, hangs, goes_on)
            with ThreadedRecorder(disk, say=tell) as recorder:
                for tick in range(1200, 1300):
                    recorder.append(row(tick))
                assert hangs.wait(30)

    monkeypatch.setattr(recorder_module, "_PATIENCE", 0.05)
    with pytest.raises(KeyboardInterrupt):
        ridden()
    goes_on.set()
    assert "for the disk: " in said[0]
    assert 1000 <= open_run(tmp_path / "run.h5").ticks <= 1200


def test_frames_that_have_no_place_are_a_fault_too(tmp_path: Path):
    with writer(tmp_path / "run.h5") as record, ThreadedRecorder(record, tmp_path) as recorder:
        deadline = time.monotonic() + 5
        while not recorder.trouble and time.monotonic() < deadline:
            time.sleep(0.01)
        assert "IsADirectoryError" in recorder.trouble


def test_no_thread_is_left(tmp_path: Path):
    with writer(tmp_path / "run.h5") as record, ThreadedRecorder(record):
        pass
    assert not [one for one in threading.enumerate() if one.name == "recorder"]
