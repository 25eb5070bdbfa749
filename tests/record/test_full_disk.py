"""A disk that fills: a limit on the size of files refuses the same writes, without any rights."""

import errno
import os
from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.record.reader import open_run


def test_a_run_that_has_no_room_is_not_begun(record, tmp_path: Path, file_size_limit):
    with file_size_limit(1_000_000), pytest.raises(InputError, match=r"run\.h5: cannot be written"):
        record(60_000)
    assert list(tmp_path.iterdir()) == []


def test_what_was_there_before_stays(record, tmp_path: Path, file_size_limit):
    (tmp_path / "run.h5").write_text("precious")
    with file_size_limit(1_000_000), pytest.raises(InputError):
        record(60_000, force=True)
    assert (tmp_path / "run.h5").read_text() == "precious"


def test_a_run_that_outgrows_the_disk_is_kept(record, tmp_path: Path, file_size_limit):
    writer = record(2000)
    message = r"run\.h5: cannot be written: file too large; the 2000 ticks before \(20 s\) are kept"
    with file_size_limit(500_000), pytest.raises(InputError, match=message), writer:
        writer.ride(60_000)
    run = open_run(writer.path)
    assert run.complete
    assert run.ticks == 2000
    assert list(tmp_path.iterdir()) == [writer.path]


def test_without_room_for_the_smaller_copy_the_record_is_whole(record, file_size_limit):
    writer = record(5000)
    writer.ride(100)
    with file_size_limit(100_000):
        writer.close()
    run = open_run(writer.path)
    assert (run.complete, run.ticks) == (True, 100)


def test_a_disk_that_takes_nothing_more_leaves_what_it_has(record, file_size_limit):
    writer = record(5000)
    writer.ride(120)
    with file_size_limit(1000), pytest.raises(InputError) as raised:
        writer.close()
    assert "file too large; the 100 ticks before (1 s) are kept" in str(raised.value)
    assert "\n" not in str(raised.value)
    assert open_run(writer.path).ticks == 100


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EIO], ids=errno.errorcode.get)
def test_a_block_that_is_refused_leaves_those_before(record, monkeypatch, code: int):
    def refuse(*_: object) -> int:
        raise OSError(code, os.strerror(code))

    writer = record(500)
    writer.ride(100)
    monkeypatch.setattr(os, "pwrite", refuse)
    with pytest.raises(InputError, match=r"the 100 ticks before \(1 s\) are kept"), writer:
        writer.ride(100)
    run = open_run(writer.path)
    assert (run.ticks, run.complete) == (100, True)


def test_a_disk_that_takes_only_a_part_is_asked_again(record, monkeypatch):
    pwrite = os.pwrite
    monkeypatch.setattr(os, "pwrite", lambda file, data, place: pwrite(file, data[:100], place))
    with record(120) as writer:
        writer.ride(120)
    assert open_run(writer.path).channel("steer")[-1] == 119
