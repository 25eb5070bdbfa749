"""What the other commands make of a bench's record, and what `--report` says of it."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io

from bikesim.bench.report import timing_figure, timing_json, timing_report, timing_told
from bikesim.bench.rig import BENCH_CHANNELS
from bikesim.bench.scenario import header_text
from bikesim.cli.main import main
from bikesim.experiment.run import scenario_bicycle
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import RunHeader
from bikesim.record.provenance import Provenance
from bikesim.record.reader import open_run
from bikesim.record.writer import RunWriter
from bikesim.report.run_figure import run_figure

from .lockstep import LockStep, leaning, profile

Cli = Callable[..., str]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a ride of a second and a half, ended by the emergency stop, on a loop that was late."""
    bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning(duration=3.0))
    lateness = np.random.default_rng(3).gamma(0.4, 4e-4, 10_000)
    show = bench.plant.show

    def shown(bicycle) -> None:
        show(bicycle)
        bench.sim.hang = float(lateness[round(bicycle.time / 1e-3)])
        bench.plant.node.estop_closed = bicycle.time < 1.5

    def hooked() -> None:
        bench.parts.rig.hooks = bench.parts.rig.hooks._replace(show=shown)

    ending = bench.ride(before=hooked)
    path = tmp_path_factory.mktemp("bench") / "ride.h5"
    header = RunHeader(
        scenario=header_text(bench.order.bench, bench.order.scenario),
        bicycle=scenario_bicycle(bench.scenario), law=bench.order.scenario.law,
        handlebar_inertia=0.2311, rig="bench", rider="person", seed=1,
        provenance=Provenance.gather(),
    )  # fmt: skip
    with RunWriter(
        path, channels=(*TICK_CHANNELS, *BENCH_CHANNELS), period=1e-3, planned_ticks=4000,
        header=header,
    ) as writer:  # fmt: skip
        for row in bench.rows:
            writer.append(row)
        writer.finish(ending)
    return path


@pytest.fixture
def record(kept: Path, tmp_path: Path) -> Path:
    """A copy, which may be written to."""
    copy = tmp_path / "ride.h5"
    copy.write_bytes(kept.read_bytes())
    return copy


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str]) -> Cli:
    def call(*arguments: object) -> str:
        capsys.readouterr()
        assert main([str(one) for one in arguments]) == 0
        return capsys.readouterr().out

    return call


def test_info_tells_the_fault_and_every_channel(cli: Cli, record: Path):
    told = cli("info", record)
    assert "fault 21: emergency stop" in told.partition("\n")[0]
    about = json.loads(cli("info", record, "--json"))
    assert (about["rig"], about["rider"]) == ("bench", "person")
    assert {one.name for one in BENCH_CHANNELS} <= {one["name"] for one in about["channels"]}


def test_export_keeps_what_the_bus_said(cli: Cli, record: Path):
    """Read back by pandas, pyarrow and scipy, against HDF5's own reader."""
    with h5py.File(record) as file:
        channels = file["channels"]
        assert isinstance(channels, h5py.Group)
        raw = {name: np.asarray(channels[name]) for name in channels}
    for suffix in ("csv", "parquet", "mat"):
        cli("export", record, record.with_suffix(f".{suffix}"))
    csv = pd.read_csv(record.with_suffix(".csv"))
    parquet = pd.read_parquet(record.with_suffix(".parquet"))
    matlab = scipy.io.loadmat(record.with_suffix(".mat"))["data"][0, 0]
    for name, unit in (
        ("sample_time", "_s"),
        ("late", "_s"),
        ("motor_torque", "_N_m"),
        ("fault", ""),
    ):
        assert np.ptp(raw[name]) > 0
        np.testing.assert_array_equal(csv[name + unit], raw[name])
        np.testing.assert_array_equal(parquet[name], raw[name])
        np.testing.assert_array_equal(matlab[name].ravel(), raw[name])


def test_it_is_drawn(cli: Cli, record: Path):
    cli("plot", record)
    cli("plot", record, record, "-o", record.with_name("two.pdf"))
    drawn = run_figure([open_run(record)]).axes[2].lines[1]
    assert np.array_equal(drawn.get_ydata(), open_run(record).channel("motor_torque"))
    assert record.with_suffix(".png").stat().st_size > 10_000
    assert record.with_name("two.pdf").stat().st_size > 5_000


def test_the_law_is_found_again_in_it(cli: Cli, record: Path):
    """Late ticks, a lag of the display and a fault change nothing in it."""
    found = json.loads(cli("replay", record, "--json"))
    assert found["compared_rows"] == open_run(record).ticks
    assert found["max_torque_error_N_m"] == 0.0
    assert found["max_ridden_again_torque_error_N_m"] == 0.0


def test_a_picture_of_it(cli: Cli, record: Path):
    still = record.with_suffix(".still.png")
    cli("render", record, "--at", "1", "--size", "320x180", "--quality", "draft", "-o", still)
    assert still.stat().st_size > 1000


class TestReport:
    def test_percentiles_are_numpys(self, record: Path):
        with h5py.File(record) as file:
            late = 1e6 * np.asarray(file["channels/late"])
            compute = 1e6 * np.asarray(file["timing/compute_time"])
            skipped = int(np.asarray(file["channels/skipped"])[-1])
        told = timing_json(timing_report(open_run(record)))
        assert told["ticks"] == len(late)
        assert told["skipped"] == skipped > 0
        for name, values in (("late_us", late), ("compute_us", compute)):
            assert told[name] == pytest.approx(
                {
                    "p50": np.percentile(values, 50),
                    "p99": np.percentile(values, 99),
                    "p99.9": np.percentile(values, 99.9),
                    "max": values.max(),
                }
            )

    def test_each_line_of_the_histogram_counts_its_ticks(self, record: Path):
        run = open_run(record)
        late = 1e6 * run.channel("late")
        lines = timing_told(timing_report(run), histogram=True)
        first = next(i for i, line in enumerate(lines) if line.startswith("late"))
        last = next(i for i, line in enumerate(lines) if line.startswith("compute"))
        total = 0
        longest = 0
        for line in lines[first + 1 : last]:
            found = re.fullmatch(r"\s*(?:(\d+) to (\d+)|from (\d+)) µs (#*)\s+(\d+)", line)
            assert found, line
            low, high, beyond, bar, count = found.groups()
            edges = (float(low or beyond), float(high or "inf"))
            assert int(count) == np.sum((edges[0] <= late) & (late < edges[1])) > 0
            total += int(count)
            longest = max(longest, len(bar))
        assert total == run.ticks
        assert longest == 40

    def test_a_person_reads_the_same_numbers(self, record: Path):
        run = open_run(record)
        line = next(
            one for one in timing_told(timing_report(run), histogram=False) if one[:4] == "late"
        )
        values = np.percentile(1e6 * run.channel("late"), [50, 99, 99.9, 100])
        told = [float(one) for one in re.findall(r"(?:p50|p99|p99\.9|max) (\d+)", line)]
        assert told == pytest.approx(values, abs=0.5)

    def test_the_figure_marks_them(self, record: Path):
        run = open_run(record)
        figure = timing_figure(run, timing_report(run))
        for axis, values in zip(
            figure.axes, (run.channel("late"), run.timing("compute_time")), strict=True
        ):
            counted = sum(patch.get_height() for patch in axis.patches)  # type: ignore[attr-defined]
            assert counted == run.ticks
            marks = sorted(line.get_xdata()[0] for line in axis.lines)  # type: ignore[index]
            wanted = np.percentile(1e6 * values, [50, 99, 99.9, 100])
            assert marks == pytest.approx(np.maximum(wanted, 1.0))
