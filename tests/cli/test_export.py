import csv
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
import scipy.io

from bikesim.record.reader import open_run


@pytest.fixture
def exported(cli, record: Path):
    """The run, and the file that the command made of it."""

    def to(name: str):
        said = cli("export", "run.h5", name)
        assert (said.status, said.err) == (0, "")
        assert said.out.endswith(f"{name}: 1000 ticks\n")
        return open_run(record), Path(name)

    return to


def test_csv_reads_back_bit_for_bit(exported):
    run, path = exported("run.csv")
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    table = dict(zip(header, np.array(rows, float).T, strict=True))
    assert np.array_equal(table["roll_rad"], run.channel("roll"))
    assert np.array_equal(table["sent_torque_N_m"], run.channel("sent_torque"))
    assert len(table) == len(run.channels) + len(run.timing_channels)


def test_parquet_reads_back_bit_for_bit(exported):
    run, path = exported("run.parquet")
    table = pyarrow.parquet.read_table(path)
    for name in run.names:
        assert np.array_equal(table[name].to_numpy(), run.channel(name))


def test_mat_reads_back_bit_for_bit(exported):
    run, path = exported("run.mat")
    data = scipy.io.loadmat(path, squeeze_me=True, simplify_cells=True)["data"]
    for name in run.names:
        assert np.array_equal(data[name], run.channel(name))


def test_what_is_there_stays_without_force(cli, refusal, record: Path):
    Path("run.csv").write_text("precious")
    message = refusal("export", "run.h5", "run.csv")
    assert "run.csv: is already there; --force replaces it" in message
    assert Path("run.csv").read_text() == "precious"
    assert cli("export", "run.h5", "run.csv", "--force").status == 0


def test_a_record_is_never_exported_over_itself(refusal, record: Path):
    named = record.rename("run.csv")
    before = named.read_bytes()
    assert "run.csv: would replace" in refusal("export", "run.csv", "run.csv", "--force")
    assert named.read_bytes() == before


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("run.xyz", "run.xyz: cannot export to '.xyz'; known: .csv, .parquet, .mat"),
        ("run", "run: cannot export to ''; known: .csv"),
        ("/proc/run.csv", "/proc/run.csv: cannot be written"),
        (".", "cannot export to ''"),
    ],
)
def test_an_output_that_cannot_be(refusal, record: Path, output: str, message: str):
    assert message in refusal("export", "run.h5", output)


@pytest.mark.parametrize(
    ("arguments", "missing"), [((), "RUN.h5"), (("run.h5",), "OUTPUT")], ids=["both", "output"]
)
def test_what_is_missing_is_named(refusal, arguments, missing: str):
    message = refusal("export", *arguments)
    assert message == f"bikesim: {missing} is missing (bikesim export --help)\n"
