"""A Dask cluster that is there already: its workers may lack what the experiment began with."""

import time
from collections.abc import Iterator
from typing import Any

import pytest
from distributed import LocalCluster

from bikesim.errors import InputError
from bikesim.experiment.study.crew import Answered
from bikesim.experiment.study.dask_crew import DaskCrew
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.versions import Versions
from bikesim.experiment.study.work import Done, Refused, order_of

NO_BIKESIM = "import sys; sys.modules['bikesim'] = None"
OLD_BIKESIM = "import bikesim; bikesim.__version__ = '0.0.1'"
FAR = 30.0  # [s] that nothing here takes


class Cluster:
    """Workers are processes, which begin by running a line of Python."""

    def __init__(self, cluster: Any) -> None:
        self._cluster = cluster
        self._count = 0
        self.address = cluster.scheduler_address

    def add(self, begins: str = "") -> None:
        """One worker more."""
        spec = self._cluster.new_spec
        options = {**spec["options"], "preload": [begins] if begins else []}
        self._cluster.new_spec = {**spec, "options": options}
        self.scale(self._count + 1)

    def never_again(self) -> None:
        """The scheduler itself gives no batch a second time."""
        self._cluster.scheduler.allowed_failures = 0

    def scale(self, count: int) -> None:
        self._cluster.scale(count)
        self._count = count
        deadline = time.monotonic() + FAR
        while len(self._cluster.scheduler.workers) != count:
            assert time.monotonic() < deadline
            time.sleep(0.05)


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    with LocalCluster(
        n_workers=0, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50
    ) as cluster:
        yield Cluster(cluster)


def refusal(cluster: Cluster) -> str:
    with pytest.raises(InputError) as raised, DaskCrew(scheduler=cluster.address):
        pass
    assert "\n" not in str(raised.value)
    return str(raised.value)


def answered(crew: DaskCrew, study: Study) -> Answered:
    crew.give(order_of(study, next(study.batches(set(), 512, 1))))
    deadline = time.monotonic() + FAR
    while not (events := crew.wait(1.0)):
        assert time.monotonic() < deadline
    assert isinstance(events[0], Answered)
    return events[0]


def test_workers_without_this_bikesim_are_told_kind_by_kind(cluster):
    cluster.add(NO_BIKESIM)
    cluster.add(OLD_BIKESIM)
    cluster.add(OLD_BIKESIM)
    ours = Versions.gather()
    message = refusal(cluster)
    assert message.startswith(
        f"--scheduler {cluster.address}: 1 of its 3 workers: ModuleNotFoundError: "
    )
    old = ours._replace(bikesim="0.0.1")
    assert message.endswith(f"; 2 of its 3 workers: {old}; this is {ours}")


@pytest.mark.parametrize(
    ("begins", "told"),
    [(NO_BIKESIM, "its Dask worker cannot ride: ModuleNotFoundError: "),
     (OLD_BIKESIM, "its worker has bikesim 0.0.1, ")],
)  # fmt: skip
def test_one_that_comes_later_is_found_by_the_batch_it_is_given(cluster, small, begins, told):
    cluster.add()
    with DaskCrew(scheduler=cluster.address) as crew:
        assert isinstance(answered(crew, small).answer, Done)
        cluster.scale(0)
        cluster.add(begins)
        answer = answered(crew, small).answer
    assert isinstance(answer, Refused)
    assert answer.why.startswith(told)
    assert "\n" not in answer.why


def test_a_scheduler_that_repeats_batches_itself_is_told(cluster, capsys):
    cluster.add()
    with DaskCrew(scheduler=cluster.address):
        pass
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("note: this Dask scheduler gives a batch whose worker dies to 3 more ")


def test_one_that_does_not_is_not(cluster, capsys):
    cluster.add()
    cluster.never_again()
    with DaskCrew(scheduler=cluster.address):
        pass
    assert capsys.readouterr().err == ""
