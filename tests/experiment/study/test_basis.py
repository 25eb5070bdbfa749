"""What a batch was planned with is what it is ridden with, or it is not ridden."""

import pickle
from pathlib import Path

import pytest

from bikesim.experiment.study.folder import open_folder
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.results import read_results
from bikesim.experiment.study.versions import Versions
from bikesim.experiment.study.work import Answer, Done, Refused, Ride, order_of, work

OTHER = Versions("0.0.1", "4.0.0", "2.0", "0123456789ab")
RIDER = """
from gains import GAIN

class Mine:
    def __init__(self, setting): ...
    def intend(self, steer, steer_rate, seen):
        return GAIN * seen.roll
"""


def order(study: Study) -> Ride:
    """As a worker gets it."""
    return pickle.loads(pickle.dumps(order_of(study, next(study.batches(set(), 512, 1)))))


def answer(order: Ride) -> Answer:
    return work(order, lambda _: False)


@pytest.fixture
def mine(make, tmp_path: Path) -> Study:
    """Two runs of a rider of the user's own, who imports a file from beside his."""
    (tmp_path / "mine.py").write_text(RIDER)
    (tmp_path / "gains.py").write_text("GAIN = 1.0\n")
    return make("seeds = 2\nscenario.duration = 0.1\nscenario.rider = 'mine.py:Mine'")


def test_the_same_is_ridden_and_says_with_what(mine):
    done = answer(order(mine))
    assert isinstance(done, Done)
    assert done.versions == Versions.gather()


def test_a_worker_with_other_software_refuses(small, monkeypatch):
    given, ours = order(small), Versions.gather()
    monkeypatch.setattr(Versions, "gather", lambda: OTHER)
    told = f"its worker has {OTHER}; the experiment began with {ours}"
    assert answer(given) == Refused(told)


def test_one_whose_riders_file_is_another_refuses(mine, tmp_path: Path):
    given = order(mine)
    (tmp_path / "gains.py").write_text("GAIN = 2.0\n")
    told = "for its worker it is not the one that the experiment began with"
    assert answer(given) == Refused(f"{tmp_path / 'gains.py'}: {told}")


def test_one_without_a_file_refuses(mine, tmp_path: Path):
    given = order(mine)
    (tmp_path / "gains.py").unlink()
    told = "its worker has none, the experiment began with one"
    assert answer(given) == Refused(f"{tmp_path / 'gains.py'}: {told}")


def test_batches_given_later_are_of_the_files_of_the_beginning(mine, tmp_path: Path):
    with open_folder(tmp_path / "results", mine, force=False):
        (tmp_path / "gains.py").write_text("GAIN = 2.0\n")
        assert isinstance(answer(order(mine)), Refused)


def test_rows_say_what_their_worker_had(small, tmp_path: Path):
    done = answer(order(small))
    assert isinstance(done, Done)
    with open_folder(tmp_path, small, force=False) as folder:
        folder.add(1, done._replace(versions=OTHER), "test-1")
        folder.merge()
    table = read_results(tmp_path).table
    assert {tuple(row) for row in table[list(Versions._fields)].to_numpy()} == {tuple(OTHER)}
