"""Batches become a table, whatever happens to those who ride them."""

import itertools
import math
import time
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest

from bikesim.errors import InputError
from bikesim.experiment.history import History
from bikesim.experiment.metrics import Metrics, measure
from bikesim.experiment.run import build, run
from bikesim.experiment.study.columns import PROVENANCE
from bikesim.experiment.study.conduct import Conducted, ride_batches, ride_kept, told
from bikesim.experiment.study.folder import open_folder
from bikesim.experiment.study.plan import Study, make_study
from bikesim.experiment.study.reading import parse_experiment
from bikesim.experiment.study.results import read_results
from bikesim.experiment.study.work import Done, order_of, scenario_of, work
from bikesim.record.reader import open_run

from .conftest import SMALL
from .crews import OwnHands


def conduct(
    study: Study,
    path: Path,
    crew: OwnHands,
    *,
    size: int = 512,
    workers: int = 1,
    interrupted: Callable[[], bool] = lambda: False,
) -> Conducted:
    with open_folder(path, study, force=False) as folder:
        batches = study.batches(folder.done, size, workers)
        try:
            return ride_batches(study, batches, folder, crew, interrupted)
        finally:
            folder.merge()


def table(path: Path) -> pd.DataFrame:
    return read_results(path).table


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> tuple[Study, pd.DataFrame, pd.DataFrame]:
    """The small experiment in one batch a law, and in batches of two."""
    study = make_study(parse_experiment(SMALL, None))
    tables = []
    for size in (512, 2):
        path = tmp_path_factory.mktemp("results")
        assert conduct(study, path, OwnHands(), size=size, workers=2).whole
        tables.append(table(path))
    return study, *tables


class TestTable:
    def test_has_a_row_a_run_with_factors_and_seed(self, whole):
        rows = whole[1]
        assert rows["run"].tolist() == [f"{c}-{seed}" for c in (1, 2, 3, 4) for seed in (1, 2, 3)]
        assert rows["law"].tolist() == ["paper"] * 6 + ["off"] * 6
        assert rows["rider.visual_delay"].tolist() == [0.1, 0.1, 0.1, 0.2, 0.2, 0.2] * 2
        assert rows["seed"].tolist() == [1, 2, 3] * 4
        assert set(rows["ticks"]) == {200}
        assert set(rows["ending"]) == {"end of run"}
        assert set(Metrics._fields) <= set(rows.columns)

    def test_does_not_depend_on_the_batches(self, whole):
        _, one, other = (
            rows if i == 0 else rows.drop(columns=list(PROVENANCE)) for i, rows in enumerate(whole)
        )
        pd.testing.assert_frame_equal(one, other, check_exact=True)

    def test_has_the_metrics_of_the_run_ridden_alone(self, whole, tmp_path: Path):
        study, rows, _ = whole
        row = rows.iloc[7]
        scenario = scenario_of(
            study.condition(int(row["condition_number"])).scenario, int(row["seed"])
        )
        run(build(scenario), tmp_path / "alone.h5")
        alone = measure(History.of_run(open_run(tmp_path / "alone.h5")), scenario)
        for name, value in alone._asdict().items():
            # Places by array cosines may differ from those by scalar ones in the last digit.
            close = pytest.approx(value, rel=1e-9, abs=1e-15)
            assert row[name] == close or (math.isnan(row[name]) and math.isnan(value)), name


class TestInterrupted:
    def test_what_is_computed_stays_and_the_rest_comes_later(self, small, tmp_path: Path):
        crew = OwnHands()
        first = conduct(small, tmp_path, crew, size=3, interrupted=lambda: len(crew.turns) == 2)
        assert not first.whole
        assert len(table(tmp_path)) == 6
        crew = OwnHands()
        assert conduct(small, tmp_path, crew, size=3).whole
        assert len(crew.turns) == 2
        assert len(table(tmp_path)) == 12

    def test_a_batch_cut_short_leaves_nothing(self, make, monkeypatch):
        # The second rider falls at once; the first rides on until he is stopped. To keep the
        # fall alone would make a rate of falls that is none.
        study = make(
            "seeds = 1\nscenario.duration = 0.5\n"
            "[factors]\n'start.roll_rate_deg_s' = [0.0, 360.0]\n"
        )
        seconds = itertools.count(0, 1e-3)
        monkeypatch.setattr(time, "perf_counter", lambda: next(seconds))
        order = order_of(study, next(study.batches(set(), 512, 1)))
        done = work(order, lambda fraction: fraction > 0.6)
        assert isinstance(done, Done)
        assert (done.results, done.metrics) == ((), ())


class TestLost:
    def test_a_batch_whose_worker_dies_is_ridden_once_more(self, small, tmp_path: Path):
        crew = OwnHands(lose=lambda batch, turn: batch == 2 and turn == 0)
        assert conduct(small, tmp_path, crew, size=3) == Conducted(True, ())
        assert crew.turns == [1, 2, 2, 3, 4]
        assert len(table(tmp_path)) == 12

    def test_one_that_goes_on_killing_them_is_given_up_and_told(self, small, tmp_path: Path):
        crew = OwnHands(lose=lambda batch, turn: batch == 2)
        conducted = conduct(small, tmp_path, crew, size=3)
        assert not conducted.whole
        assert crew.turns == [1, 2, 2, 3, 4]
        assert len(table(tmp_path)) == 9
        assert told(conducted.given_up[0]).startswith(
            "batch 2 (3 runs, the first 2-1): its worker ended twice (signal SIGKILL)"
        )


class TestWrong:
    def test_what_a_rider_does_wrong_is_told_and_the_rest_stays(self, make, tmp_path: Path):
        (tmp_path / "mine.py").write_text(
            "class Mine:\n"
            "    def __init__(self, setting, *, limit=1.0): self.limit = limit\n"
            "    def intend(self, steer, steer_rate, seen):\n"
            "        return 0.0 if seen.time < self.limit else 1 / 0\n"
        )
        study = make(
            "seeds = 2\nbatch_size = 2\nscenario.duration = 0.2\n"
            "scenario.rider.name = 'mine.py:Mine'\n"
            "factors.limit = { key = 'rider.figures.limit', values = [1.0, 0.1] }"
        )
        with pytest.raises(InputError) as raised:
            conduct(study, tmp_path / "results", OwnHands(), size=2)
        assert "ZeroDivisionError" in str(raised.value)
        assert f"2 of 4 runs are kept in {tmp_path / 'results'}" in str(raised.value)
        assert table(tmp_path / "results")["run"].tolist() == ["1-1", "1-2"]


def test_kept_runs_are_the_records_of_the_table(small, tmp_path: Path):
    asked = small.experiment.model_copy(update={"keep": "first"})
    study = Study(asked, small.factors, small.conditions)
    conduct(study, tmp_path, OwnHands())
    with open_folder(tmp_path, study, force=False) as folder:
        assert ride_kept(study, folder, OwnHands(), lambda: False).whole
        again = OwnHands()
        assert ride_kept(study, folder, again, lambda: False).whole
        assert again.turns == []
        folder.merge()
    rows = pq.read_table(tmp_path / "results.parquet").to_pylist()
    assert [row["record"] is not None for row in rows] == [row["seed"] == 1 for row in rows]
    for row in (row for row in rows if row["seed"] == 1):
        record = open_run(tmp_path / row["record"])
        assert record.ticks == row["ticks"]
        assert record.seed == 1
        assert record.law == row["law"]


def test_a_kept_run_that_is_not_that_of_the_table_is_told(
    small, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """As a rider would leave it who rides otherwise in a batch, for just as long."""
    asked = small.experiment.model_copy(update={"keep": "first"})
    study = Study(asked, small.factors, small.conditions)
    conduct(study, tmp_path, OwnHands())
    rows = pq.read_table(tmp_path / "results.parquet")
    steer = [value * (1 + 1e-5 * (i == 3)) for i, value in enumerate(rows["steer_rms"].to_pylist())]
    column = rows.column_names.index("steer_rms")
    pq.write_table(
        rows.set_column(column, rows.field(column), [steer]), tmp_path / "results.parquet"
    )
    with open_folder(tmp_path, study, force=False) as folder:
        assert ride_kept(study, folder, OwnHands(), lambda: False).whole
    told = capsys.readouterr().err
    assert told.startswith(
        "note: 1 of 4 kept runs are not those of the table, the first 2-1: steer_rms is "
    )
    assert told.count("\n") == 1
