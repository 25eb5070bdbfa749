import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.record.channels import Channel
from bikesim.record.header import Ending, RunHeader
from bikesim.record.reader import open_run
from bikesim.record.writer import RunWriter


@pytest.mark.parametrize("planned", [500, 5000, 40, None], ids=str)
@pytest.mark.parametrize("ticks", [0, 1, 49, 50, 51, 500])
def test_what_was_appended_is_read(record, planned: int | None, ticks: int):
    with record(planned) as writer:
        writer.ride(ticks)
    run = open_run(writer.path)
    rows = np.array([writer.row(tick) for tick in range(ticks)])
    columns = [run.channel(name) for name in run.names]
    columns += [run.timing("wall_time"), run.timing("compute_time")]
    assert np.array_equal(np.column_stack(columns), rows.reshape(ticks, len(columns)))


def test_a_closed_file_has_the_true_length(record):
    with record(5000) as writer:
        writer.ride(120)
    with h5py.File(writer.path) as opened:
        file: Any = opened
        assert {len(dataset) for dataset in file["channels"].values()} == {120}


def test_room_that_was_not_used_is_given_back(record):
    with record(100_000) as long, record(120, "short.h5") as short:
        long.ride(120)
        short.ride(120)
    assert long.path.stat().st_size == short.path.stat().st_size


def test_no_other_file_is_left(record, tmp_path: Path):
    with record(40) as writer:
        writer.ride(120)
    assert list(tmp_path.iterdir()) == [writer.path]


def test_a_run_can_be_read_while_it_is_written(record):
    with record(5000) as writer:
        writer.ride(120)
        run = open_run(writer.path)
        assert (run.ticks, run.complete, run.ending) == (100, False, None)


def test_a_slow_loop_is_written_by_the_clock_on_the_wall(record):
    with record(5000) as writer:
        for tick in range(5):
            writer.append(writer.row(tick, wall_time=0.2 * tick))
        assert open_run(writer.path).ticks == 4


def test_ticks_counts_what_was_appended(record):
    with record(5000) as writer:
        writer.ride(120)
        assert writer.ticks == 120


def test_the_ending_is_kept(record):
    with record(500) as writer:
        writer.ride(120)
        writer.finish(Ending("fell", fell=True, fall_time=1.19))
    assert open_run(writer.path).ending == Ending("fell", fell=True, fall_time=1.19)


def test_a_long_reason_is_cut_to_one_line(record):
    with record(500) as writer:
        writer.finish(Ending("fault\n" + "φ" * 300))
    ending = open_run(writer.path).ending
    assert ending is not None
    assert ending.reason == "fault " + "φ" * 97


def test_the_compute_time_is_summed_up(record):
    with record(101) as writer:
        writer.ride(101)
    with h5py.File(writer.path) as file:
        assert file.attrs["compute_time_median_s"] == pytest.approx(50e-5)
        assert file.attrs["compute_time_p99_s"] == pytest.approx(99e-5)
        assert file.attrs["compute_time_max_s"] == pytest.approx(100e-5)


def test_closing_twice_changes_nothing(record):
    with record(500) as writer:
        writer.ride(120)
    before = writer.path.read_bytes()
    writer.close()
    assert writer.path.read_bytes() == before


def test_ctrl_c_keeps_every_tick(record):
    writer = record(500)
    writer.ride(120)
    with pytest.raises(KeyboardInterrupt), writer:
        raise KeyboardInterrupt
    run = open_run(writer.path)
    assert (run.ticks, run.ending) == (120, Ending("interrupted"))


def test_an_error_of_the_loop_is_the_reason(record):
    writer = record(500)
    writer.ride(120)
    with pytest.raises(RuntimeError), writer:
        raise RuntimeError("motor lost")
    run = open_run(writer.path)
    assert (run.ticks, run.ending) == (120, Ending("fault: motor lost"))


def test_a_row_of_another_length_is_refused(record):
    with record(500) as writer, pytest.raises(Exception, match="expected 20 items"):
        writer.append((0.0, 1.0))


def begin(path: Path, channels: Sequence[Channel], header: RunHeader) -> None:
    RunWriter(path, channels=channels, period=0.01, planned_ticks=1, header=header)


def test_a_channel_given_twice_is_refused(channels, header, tmp_path: Path):
    with pytest.raises(ValueError, match="each once"):
        begin(tmp_path / "run.h5", (*channels, channels[1]), header)


def test_a_run_has_a_time(channels, header, tmp_path: Path):
    with pytest.raises(ValueError, match="with the time among them"):
        begin(tmp_path / "run.h5", channels[1:], header)


class TestWhereItMayNotWrite:
    def test_a_record_that_is_there_stays(self, record, tmp_path: Path):
        (tmp_path / "run.h5").write_text("precious")
        with pytest.raises(InputError, match=r"run\.h5: is already there; --force"):
            record(500)
        assert (tmp_path / "run.h5").read_text() == "precious"

    def test_force_replaces_it(self, record, tmp_path: Path):
        (tmp_path / "run.h5").write_text("old")
        with record(500, force=True) as writer:
            writer.ride(120)
        assert open_run(writer.path).ticks == 120

    def test_force_replaces_the_file_behind_a_link(self, record, tmp_path: Path):
        (tmp_path / "link.h5").symlink_to(tmp_path / "run.h5")
        record(500, "link.h5").close()
        assert (tmp_path / "link.h5").is_symlink()
        assert (tmp_path / "run.h5").is_file()

    def test_a_folder(self, record, tmp_path: Path):
        with pytest.raises(InputError, match="is a folder"):
            record(500, ".", force=True)

    def test_a_device_is_not_replaced(self, record):
        with pytest.raises(InputError, match="not a plain file"):
            record(500, "/dev/null", force=True)
        assert Path("/dev/null").is_char_device()

    def test_a_folder_that_is_missing_is_made(self, record, tmp_path: Path):
        record(500, "a/b/run.h5").close()
        assert (tmp_path / "a/b/run.h5").is_file()

    def test_under_a_file(self, record, tmp_path: Path):
        (tmp_path / "file").write_text("")
        with pytest.raises(InputError, match="cannot be written: "):
            record(500, "file/run.h5")

    def test_a_name_too_long(self, record):
        with pytest.raises(InputError, match="cannot be written: file name too long"):
            record(500, "x" * 300)


@pytest.mark.parametrize("seed", [-1, 2**63])
def test_a_seed_that_the_file_cannot_hold_is_refused(header, seed: int):
    with pytest.raises(InputError, match=rf"seed = {seed}: from 0 to"):
        replace(header, seed=seed)


def test_three_lines_into_pandas(record, tmp_path: Path):
    with record(500) as writer:
        writer.ride(120)
    lines = [
        "import h5py, pandas as pd",
        'with h5py.File("run.h5") as f:',
        '    df = pd.DataFrame({k: f["channels"][k][:] for k in f["channels"]})',
        'print(len(df), *df.columns[:3], df["time"].iloc[-1])',
    ]
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(lines)],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.split() == ["120", "time", "steer", "steer_rate", repr(119 * 0.01)]
