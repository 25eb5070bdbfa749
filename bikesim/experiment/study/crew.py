"""Workers: processes of this machine that ride batches."""

import os
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from pickle import UnpicklingError
from typing import NamedTuple, Protocol, Self

from bikesim.child import child_command
from bikesim.experiment.study.work import Answer, Order, Progress

_ENDING = 5.0  # [s] for a process that has closed its connection
# A batch uses one core: a thread pool in each of many processes only gets in their way.
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class Answered(NamedTuple):
    """An order that was dealt with, and by whom; a name without that of a machine."""

    order: Order
    answer: Answer
    worker: str


class Lost(NamedTuple):
    """An order whose worker ended in the middle of it, and how that was."""

    order: Order
    how: str


Event = Answered | Lost


class Crew(Protocol):
    """Whoever can do several orders at once. A context manager: at the end none is at work."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    @property
    def workers(self) -> int:
        """How many orders are worked on at once."""
        ...

    @property
    def free(self) -> int:
        """How many orders more it takes now."""
        ...

    @property
    def busy(self) -> int:
        """How many orders it has."""
        ...

    @property
    def progress(self) -> float:
        """Runs done of the orders that it has, as far as it knows."""
        ...

    def give(self, order: Order) -> None:
        """Begin with an order; only when one is `free`."""
        ...

    def wait(self, seconds: float) -> Sequence[Event]:
        """What happened, at most so long from now."""
        ...

    def stop(self) -> None:
        """All at work are to end it soon; what they have by then comes as an answer."""
        ...


def cores() -> int:
    """Those that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@dataclass
class _Worker:
    name: str
    process: subprocess.Popen[bytes]
    connection: Connection
    order: Order | None = None
    progress: float = 0.0


class LocalCrew:
    """A worker a core, begun when there is work for it, replaced when it dies."""

    def __init__(self, workers: int) -> None:
        self.workers, self._begun = workers, 0
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            _end(worker)
        self._workers = []

    @property
    def free(self) -> int:
        return self.workers - self.busy

    @property
    def busy(self) -> int:
        return sum(worker.order is not None for worker in self._workers)

    @property
    def progress(self) -> float:
        return sum(w.progress * w.order.runs for w in self._workers if w.order is not None)

    def give(self, order: Order) -> None:
        worker = next((w for w in self._workers if w.order is None), None) or self._begin()
        worker.order, worker.progress = order, 0.0
        with suppress(ConnectionError):  # it has ended: `wait` finds that
            worker.connection.send(order)

    def wait(self, seconds: float) -> list[Event]:
        by_connection = {w.connection: w for w in self._workers if w.order is not None}
        events = (_heard(by_connection[one]) for one in wait(list(by_connection), seconds))  # type: ignore[arg-type]
        found = [event for event in events if event is not None]
        for worker in [w for w in self._workers if w.connection.closed]:
            self._workers.remove(worker)
        return found

    def stop(self) -> None:
        for worker in self._workers:
            if worker.order is not None:
                with suppress(ConnectionError):
                    worker.connection.send(None)

    def _begin(self) -> _Worker:
        self._begun += 1
        ours, theirs = Pipe()
        with theirs:
            process = subprocess.Popen(
                child_command("bikesim.experiment.study.worker", str(theirs.fileno())),
                pass_fds=(theirs.fileno(),),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env={**os.environ, **_ONE_THREAD},
                # Ctrl-C in a terminal is for us alone, who ask them to end.
                start_new_session=True,
            )
        worker = _Worker(f"local-{self._begun}", process, ours)
        self._workers.append(worker)
        return worker


def _heard(worker: _Worker) -> Event | None:
    assert worker.order is not None
    try:
        said = worker.connection.recv()
    # It may end in the middle of its answer.
    except (EOFError, OSError, UnpicklingError):
        return Lost(worker.order, _end(worker))
    if isinstance(said, Progress):
        worker.progress = said
        return None
    order, worker.order = worker.order, None
    return Answered(order, said, worker.name)


def _end(worker: _Worker) -> str:
    """Tidy up after a worker; how it ended."""
    worker.connection.close()
    try:
        status = worker.process.wait(_ENDING)
    except subprocess.TimeoutExpired:  # it is still there, but not to be understood
        worker.process.kill()
        status = worker.process.wait()
    return f"signal {signal.Signals(-status).name}" if status < 0 else f"status {status}"
