"""Workers that are real processes."""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bikesim.experiment.study import crew as crews
from bikesim.experiment.study.crew import Answered, Event, LocalCrew, Lost
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.work import Done, Order, Refused, order_of

FAR = 60.0  # [s] that nothing here takes


@pytest.fixture(scope="module")
def crew() -> Iterator[LocalCrew]:
    with LocalCrew(1) as crew:
        yield crew


def order(study: Study, number: int = 0) -> Order:
    return order_of(study, list(study.batches(set(), 512, 1))[number])


def answer(crew: LocalCrew, until: Callable[[], bool] = lambda: True) -> Event:
    deadline = time.monotonic() + FAR
    while time.monotonic() < deadline:
        events = crew.wait(0.1)
        if events:
            return events[0]
        until()
    raise AssertionError("no answer")


def test_an_order_is_answered_by_a_worker_that_has_no_address(crew, small):
    crew.give(order(small))
    assert (crew.free, crew.busy) == (0, 1)
    event = answer(crew)
    assert isinstance(event, Answered)
    assert isinstance(event.answer, Done)
    assert event.worker == "local-1"
    assert [one.run for one in event.answer.results] == [(c, s) for c in (1, 2) for s in (1, 2, 3)]
    assert (crew.free, crew.busy, crew.progress) == (1, 0, 0)


def test_what_cannot_be_done_is_answered_too(crew, make, tmp_path: Path):
    rider = tmp_path / "gone.py"
    rider.write_text(
        "class Gone:\n"
        "    def __init__(self, setting): ...\n"
        "    def intend(self, steer, steer_rate, seen): return 0 * steer\n"
    )
    study = make("seeds = 1\nscenario.rider.name = 'gone.py:Gone'")
    rider.unlink()
    crew.give(order(study))
    event = answer(crew)
    assert isinstance(event, Answered)
    assert isinstance(event.answer, Refused)
    assert "gone.py" in event.answer.why


def test_how_far_it_is_can_be_seen_and_it_can_be_stopped(make):
    study = make("seeds = 2\nscenario.duration = 3600.0\nfactors.law = ['paper']")
    with LocalCrew(1) as crew:
        crew.give(order(study))
        while not crew.progress:
            assert crew.wait(0.1) == []
        assert 0 < crew.progress < 2
        crew.stop()
        event = answer(crew)
        assert isinstance(event, Answered)
        assert isinstance(event.answer, Done)
        assert event.answer.results == ()


def test_a_worker_that_is_killed_is_told_and_replaced(make, small):
    study = make("seeds = 2\nscenario.duration = 3600.0")
    with LocalCrew(1) as crew:
        crew.give(order(study))
        while not crew.progress:
            crew.wait(0.1)
        os.kill(crew._workers[0].process.pid, signal.SIGKILL)
        event = answer(crew)
        assert isinstance(event, Lost)
        assert event.how == "signal SIGKILL"
        crew.give(order(small))
        event = answer(crew)
        assert isinstance(event, Answered)
        assert event.worker == "local-2"


def test_at_the_end_none_is_at_work(make):
    study = make("seeds = 2\nscenario.duration = 3600.0")
    with LocalCrew(2) as crew:
        crew.give(order(study))
        crew.give(order(study))
        processes = [worker.process for worker in crew._workers]
        assert [process.poll() for process in processes] == [None, None]
    assert [process.poll() for process in processes] == [-signal.SIGKILL] * 2


# Reads the order and says this; then it ends, or stays.
WORKER = """
import sys, time
from multiprocessing.connection import Connection
with Connection(int(sys.argv[1])) as pipe:
    pipe.recv_bytes()
    {says}
"""


@pytest.mark.parametrize(
    ("says", "how"),
    [
        # A length, and less than that.
        ("import os; os.write(pipe.fileno(), (1000).to_bytes(4, 'big') + b'half')", "status 0"),
        ("pipe.send_bytes(b'nothing that was ever pickled'); time.sleep(60)", "signal SIGKILL"),
    ],
)
def test_an_answer_that_is_not_whole_is_a_lost_worker(monkeypatch, small, says: str, how: str):
    monkeypatch.setattr(crews, "_ENDING", 0.5)
    command = [sys.executable, "-c", WORKER.format(says=says)]
    monkeypatch.setattr(crews, "child_command", lambda module, file: [*command, file])
    given = order(small)
    with LocalCrew(1) as crew:
        crew.give(given)
        assert answer(crew) == Lost(given, how)
        assert (crew.free, crew.busy) == (1, 0)


def test_the_folder_that_it_is_called_in_is_not_where_a_worker_finds_modules(small, shadowed):
    with LocalCrew(1) as crew:
        crew.give(order(small))
        event = answer(crew)
    assert isinstance(event, Answered)
    assert isinstance(event.answer, Done)
