"""The same experiment on a Dask cluster."""

import os
import time
from pathlib import Path

import pandas as pd
import pytest

from bikesim.errors import InputError
from bikesim.experiment.study.columns import PROVENANCE
from bikesim.experiment.study.conduct import ride_batches
from bikesim.experiment.study.crew import Answered, Crew
from bikesim.experiment.study.dask_crew import DaskCrew
from bikesim.experiment.study.folder import open_folder
from bikesim.experiment.study.plan import Batch, RunId, Study
from bikesim.experiment.study.results import read_results
from bikesim.experiment.study.work import Done, order_of

from .crews import OwnHands


def results(study: Study, path: Path, crew: Crew, size: int) -> pd.DataFrame:
    with open_folder(path, study, force=False) as folder, crew:
        batches = study.batches(folder.done, size, 2)
        assert ride_batches(study, batches, folder, crew, lambda: False).whole
        folder.merge()
    return read_results(path).table


def test_two_workers_compute_the_table_that_one_process_does(small, tmp_path: Path):
    mine = results(small, tmp_path / "mine", OwnHands(), 512)
    theirs = results(small, tmp_path / "theirs", DaskCrew(workers=2), 3)
    by = set(theirs["worker"])
    assert all(name.startswith("dask-") and len(name) == 11 for name in by)
    columns = list(PROVENANCE)
    pd.testing.assert_frame_equal(
        mine.drop(columns=columns), theirs.drop(columns=columns), check_exact=True
    )


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://x"])
def test_a_scheduler_that_is_not_there_is_told(address: str, monkeypatch):
    monkeypatch.setattr("bikesim.experiment.study.dask_crew._CONNECTING", 0.5)
    with pytest.raises(InputError) as raised, DaskCrew(scheduler=address):
        pass
    assert str(raised.value).startswith(f"--scheduler {address}: no Dask scheduler answers: ")
    assert "\n" not in str(raised.value)


def test_how_far_it_is_can_be_seen_and_it_can_be_stopped(make):
    study = make("seeds = 2\nscenario.duration = 3600.0")
    with DaskCrew(workers=1) as crew:
        crew.give(order_of(study, next(study.batches(set(), 512, 1))))
        deadline = time.monotonic() + 60
        while not crew.progress:
            assert crew.wait(0.1) == []
            assert time.monotonic() < deadline
        assert 0 < crew.progress < 2
        crew.stop()
        assert crew.busy == 0
        # Its worker is free again, long before the hour is over.
        crew.give(order_of(make("seeds = 1\nscenario.duration = 0.1"), Batch(1, (RunId(1, 1),))))
        while not (events := crew.wait(1.0)):
            assert time.monotonic() < deadline
        assert isinstance(events[0], Answered)


def test_stopped_it_still_gives_what_was_done(make):
    long, short = (
        order_of(study, next(study.batches(set(), 512, 1)))
        for study in (
            make("seeds = 1\nscenario.duration = 3600.0"),
            make("seeds = 2\nscenario.duration = 0.1"),
        )
    )
    with DaskCrew(workers=2) as crew:
        crew.give(long)
        crew.give(short)
        deadline = time.monotonic() + 60
        while not any(future.done() for future in crew._orders):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        crew.stop()
        assert crew.busy == 1
        (event,) = crew.wait(1.0)
        assert isinstance(event, Answered)
        assert isinstance(event.answer, Done)
        assert [one.run for one in event.answer.results] == [RunId(1, 1), RunId(1, 2)]
        assert crew.busy == 0


def test_its_workers_find_no_modules_in_the_folder_that_it_is_called_in(small, shadowed):
    with DaskCrew(workers=1) as crew:
        crew.give(order_of(small, next(small.batches(set(), 512, 1))))
        deadline = time.monotonic() + 60
        while not (events := crew.wait(1.0)):
            assert time.monotonic() < deadline
    assert isinstance(events[0], Answered)
    assert isinstance(events[0].answer, Done)
    assert "PYTHONSAFEPATH" not in os.environ


def wait_for_an_hour(crew: DaskCrew) -> None:
    for _ in range(36_000):
        crew.wait(0.1)


def test_a_cluster_that_all_workers_have_left_is_told(monkeypatch):
    monkeypatch.setattr("bikesim.experiment.study.dask_crew._DESERTED", 0.5)
    with DaskCrew(workers=1) as crew:
        crew.wait(0.0)
        crew._client.cluster.scale(0)
        with pytest.raises(InputError, match=r"has had no worker for 0\.5 s; what was computed"):
            wait_for_an_hour(crew)


def test_its_cluster_answers_nobody_over_http():
    from urllib.error import HTTPError
    from urllib.request import urlopen

    with DaskCrew(workers=1) as crew:
        server = crew._client.cluster.scheduler.http_server
        assert server.address == "127.0.0.1"
        for page in ("", "info/main/workers.html", "health", "metrics"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(f"http://127.0.0.1:{server.port}/{page}", timeout=10)
