import csv
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy.io import loadmat

from bikesim.errors import InputError
from bikesim.record.channels import Channel
from bikesim.record.export import column_name, export_run
from bikesim.record.reader import Run, open_run

SUFFIXES = (".csv", ".parquet", ".mat")


@pytest.fixture
def run(record) -> Run:
    with record(120) as writer:
        writer.ride(60)
    return open_run(writer.path)


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        ("rad", "roll_rad"),
        ("rad/s", "roll_rad_s"),
        ("rad/s²", "roll_rad_s2"),
        ("N m", "roll_N_m"),
        ("1", "roll"),
    ],
)
def test_a_column_is_named_with_its_unit(unit: str, name: str):
    assert column_name(Channel("roll", unit, "", "")) == name


class TestCsv:
    def test_reads_back_to_the_last_bit(self, run: Run, tmp_path: Path):
        table = np.loadtxt(export_run(run, tmp_path / "a.csv"), delimiter=",", skiprows=1)
        assert np.array_equal(table[:, 0], run.time)
        assert np.array_equal(table[:, -1], run.timing("compute_time"))

    def test_has_a_plain_header_and_a_line_a_tick(self, run: Run, tmp_path: Path):
        with export_run(run, tmp_path / "a.csv").open(newline="") as file:
            lines = list(csv.reader(file))
        assert lines[0][:3] == ["time_s", "steer_rad", "steer_rate_rad_s"]
        assert len(lines) == 61
        assert {len(line) for line in lines} == {len(run.channels) + 2}


class TestParquet:
    def test_reads_back_to_the_last_bit(self, run: Run, tmp_path: Path):
        table = pd.read_parquet(export_run(run, tmp_path / "a.parquet"))
        assert np.array_equal(table["time"], run.time)

    def test_says_unit_sign_and_meaning(self, run: Run, tmp_path: Path):
        schema = pq.read_schema(export_run(run, tmp_path / "a.parquet"))
        metadata = schema.field("roll").metadata
        assert metadata[b"unit"] == b"rad"
        assert metadata[b"sign"] == b"> 0 leans right"
        assert schema.metadata[b"scenario"].decode() == run.scenario


class TestMat:
    def test_reads_back_to_the_last_bit(self, run: Run, tmp_path: Path):
        content = loadmat(str(export_run(run, tmp_path / "a.mat")))
        assert np.array_equal(content["data"]["time"][0, 0][:, 0], run.time)
        assert content["unit"]["sent_torque"][0, 0][0] == "N m"
        assert np.array_equal(content["bicycle"]["M"][0, 0], run.bicycle.matrices.M)


@pytest.mark.parametrize("suffix", SUFFIXES)
class TestEveryFormat:
    def test_a_file_that_is_there_stays(self, run: Run, tmp_path: Path, suffix: str):
        path = tmp_path / f"a{suffix}"
        path.write_text("precious")
        with pytest.raises(InputError, match="is already there"):
            export_run(run, path)
        assert path.read_text() == "precious"

    def test_force_replaces_it(self, run: Run, tmp_path: Path, suffix: str):
        path = tmp_path / f"a{suffix}"
        path.write_text("old")
        assert export_run(run, path, force=True).stat().st_size > 1000

    def test_a_full_disk_leaves_no_half_file(self, run, tmp_path: Path, suffix, file_size_limit):
        before = os.listdir(tmp_path)  # noqa: PTH208
        with file_size_limit(3000), pytest.raises(InputError, match="cannot be written: file too"):
            export_run(run, tmp_path / f"a{suffix}")
        assert os.listdir(tmp_path) == before  # noqa: PTH208

    def test_a_run_without_a_tick(self, record, tmp_path: Path, suffix: str):
        writer = record(120, "empty.h5")
        writer.close()
        assert export_run(open_run(writer.path), tmp_path / f"a{suffix}").exists()


def test_an_unknown_suffix(run: Run, tmp_path: Path):
    with pytest.raises(InputError, match=r"cannot export to '.xlsx'; known: .csv, .parquet, .mat"):
        export_run(run, tmp_path / "a.xlsx")
