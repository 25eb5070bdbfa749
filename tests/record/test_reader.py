import math
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.model.parameters import PARAMETER_NAMES
from bikesim.record.header import RunHeader
from bikesim.record.reader import Run, open_run
from bikesim.record.writer import RunWriter


@pytest.fixture
def path(record) -> Path:
    with record(120) as writer:
        writer.ride(120)
    return writer.path


@pytest.fixture
def run(path: Path) -> Run:
    return open_run(path)


@pytest.mark.parametrize(
    "name", ["scenario", "law", "handlebar_inertia", "rig", "rider", "seed", "provenance"]
)
def test_the_header_comes_back(run: Run, header: RunHeader, name: str):
    assert getattr(run, name) == getattr(header, name)


def test_a_run_where_nothing_is_random_has_no_seed(header, channels, tmp_path: Path):
    header = replace(header, seed=None, provenance=replace(header.provenance, commit=None))
    path = tmp_path / "run.h5"
    RunWriter(path, channels=channels, period=0.01, planned_ticks=1, header=header).close()
    run = open_run(path)
    assert (run.seed, run.commit) == (None, None)


def test_a_long_scenario_is_kept(header, channels, tmp_path: Path):
    header = replace(header, scenario="# φ\n" * 100_000)
    path = tmp_path / "run.h5"
    RunWriter(path, channels=channels, period=0.01, planned_ticks=1, header=header).close()
    assert open_run(path).scenario == header.scenario


class TestBicycle:
    @pytest.mark.parametrize("name", ["M", "C1", "K0", "K2"])
    def test_matrices_to_the_last_bit(self, run: Run, bicycle, name: str):
        written = getattr(bicycle.matrices, name)
        assert np.array_equal(getattr(run.bicycle.matrices, name), written)

    @pytest.mark.parametrize("name", PARAMETER_NAMES)
    def test_parameters_to_the_last_bit(self, run: Run, bicycle, name: str):
        assert getattr(run.bicycle.parameters, name) == getattr(bicycle.parameters, name)

    @pytest.mark.parametrize(
        "name", ["name", "source", "wheelbase", "trail", "steer_axis_tilt", "gravity"]
    )
    def test_geometry(self, run: Run, bicycle, name: str):
        assert getattr(run.bicycle, name) == getattr(bicycle, name)

    def test_known_by_its_matrices_alone(self, header, channels, bicycle, tmp_path: Path):
        header = replace(header, bicycle=replace(bicycle, parameters=None))
        path = tmp_path / "run.h5"
        RunWriter(path, channels=channels, period=0.01, planned_ticks=1, header=header).close()
        assert open_run(path).bicycle.parameters is None


def test_channels_come_back_in_their_order(run: Run, channels):
    assert run.channels == channels


def test_time_and_period(run: Run):
    assert run.period == 0.01
    assert np.array_equal(run.time, [tick * 0.01 for tick in range(120)])


def test_versions_name_what_made_it(run: Run, header: RunHeader):
    assert ("h5py", header.provenance.h5py) in run.versions
    assert run.created == header.provenance.created


def test_a_channel_misspelt(run: Run):
    with pytest.raises(InputError, match="'stear_rate'; did you mean steer_rate"):
        run.channel("stear_rate")


def test_pandas_has_a_column_a_channel(run: Run):
    table = run.to_pandas()
    assert tuple(table.columns) == run.names
    assert table.shape == (120, len(run.names))
    assert table.attrs["units"]["roll_rate"] == "rad/s"


class TestDigest:
    def test_is_that_of_the_values(self, run: Run, tmp_path: Path):
        shutil.copy(run.path, tmp_path / "copy.h5")
        assert open_run(tmp_path / "copy.h5").digest() == run.digest()

    def test_does_not_hang_on_the_clock_or_the_room(self, run: Run, record):
        with record(500, "other.h5") as writer:
            for tick in range(120):
                writer.append(writer.row(tick, wall_time=tick))
        assert open_run(writer.path).digest() == run.digest()

    def test_shows_the_last_bit(self, run: Run):
        digest = run.digest()
        with h5py.File(run.path, "r+") as file:
            values: Any = file["channels/roll"]
            values[3] = math.nextafter(values[3], math.inf)
        assert open_run(run.path).digest() != digest


def damage(path: Path, how: str) -> None:
    content = path.read_bytes()
    match how:
        case "empty":
            path.write_bytes(b"")
        case "is not an HDF5 file":
            path.write_text("time,roll\n0,0\n")
        case "truncated or damaged":
            path.write_bytes(content[: len(content) // 2])
        case "truncated or damaged run file":
            path.write_bytes(content[:10])
        case "no such file":
            path.unlink()
        case "is a folder":
            path.unlink()
            path.mkdir()


@pytest.mark.parametrize(
    "how",
    [
        "empty",
        "is not an HDF5 file",
        "truncated or damaged",
        "truncated or damaged run file",
        "no such file",
        "is a folder",
    ],
)
def test_what_is_not_a_run_file_is_told_in_one_line(path: Path, how: str):
    damage(path, how)
    with pytest.raises(InputError, match=how) as raised:
        open_run(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert "\n" not in str(raised.value)


def test_hdf5_of_another_kind(tmp_path: Path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(InputError, match="not a run of bikesim"):
        open_run(tmp_path / "other.h5")


def test_a_file_of_a_newer_format(path: Path):
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 2
    with pytest.raises(InputError, match=r"newer bikesim \(format 2\)"):
        open_run(path)


@pytest.mark.parametrize("part", ["channels", "channels/time", "timing", "bicycle", "bicycle/M"])
def test_a_part_that_is_missing(path: Path, part: str):
    with h5py.File(path, "r+") as file:
        del file[part]
    with pytest.raises(InputError, match="truncated or damaged run file"):
        open_run(path)


def test_columns_of_unequal_length(path: Path):
    with h5py.File(path, "r+") as file:
        del file["channels/roll"]
        file["channels/roll"] = np.zeros(3)
        for name in ("unit", "sign", "description"):
            file["channels/roll"].attrs[name] = ""
    with pytest.raises(InputError, match="roll and the time differ in length"):
        open_run(path)
