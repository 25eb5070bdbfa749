"""Workers of a Dask cluster: one that is there already, or one of this machine."""

import os
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any, Self

from bikesim.errors import InputError
from bikesim.experiment.study.crew import Answered, Event, Lost
from bikesim.experiment.study.dask_worker import TOPIC, answer_of, call, do, software
from bikesim.experiment.study.work import Order, Refused

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

_CONNECTING = 10.0  # [s]
_DESERTED = 60.0  # [s]; a worker that died is replaced within a few
_SAFE_PATH = "PYTHONSAFEPATH"
_ROUTES = "distributed.scheduler.http.routes"


class DaskCrew:
    """Orders go to the cluster's workers. Raises InputError for one that cannot be reached."""

    def __init__(self, *, scheduler: str | None = None, workers: int = 1) -> None:
        self._scheduler, self._count = scheduler, workers
        self._open = ExitStack()
        self._orders: dict[Future, Order] = {}
        self._fractions: dict[Any, float] = {}

    def __enter__(self) -> Self:
        with ExitStack() as opening:
            client: Any = self._connected(opening)
            self._client = opening.enter_context(client)
            self._check_versions()
            self._tell_repeats()
            self._inhabited = time.monotonic()
            self._client.subscribe_topic(TOPIC, self._hear)
            self._open = opening.pop_all()
        return self

    def __exit__(self, *exception: Any) -> None:
        # Its own tidying is loud where a worker has died.
        with suppress(Exception):
            self._client.cancel(list(self._orders))
        self._orders.clear()
        self._open.close()

    @property
    def workers(self) -> int:
        threads: Any = self._client.nthreads()
        return sum(threads.values())

    @property
    def free(self) -> int:
        # One more for each, so that none waits for us.
        return max(0, 2 * self.workers - len(self._orders))

    @property
    def busy(self) -> int:
        return len(self._orders)

    @property
    def progress(self) -> float:
        told = self._fractions
        return sum(told.get(future.key, 0.0) * order.runs for future, order in self._orders.items())

    def give(self, order: Order) -> None:
        # Not pure: an order that was lost is given again.
        self._orders[self._client.submit(*call(do, order), pure=False)] = order

    def wait(self, seconds: float) -> list[Event]:
        from distributed import wait

        self._check_inhabited()
        if not self._orders:
            time.sleep(seconds)
            return []
        try:
            found: Any = wait(list(self._orders), timeout=seconds, return_when="FIRST_COMPLETED")
        except TimeoutError:
            return []
        return [self._event(future) for future in found.done]

    def stop(self) -> None:
        """What is being ridden is given up; what has been ridden is still to be waited for."""
        given_up = [future for future in self._orders if not future.done()]
        self._client.cancel(given_up)
        for future in given_up:
            del self._orders[future]

    def _check_inhabited(self) -> None:
        """Raises InputError where all workers have gone and none has come for a while."""
        now = time.monotonic()
        if self.workers:
            self._inhabited = now
        elif now - self._inhabited > _DESERTED:
            raise InputError(
                f"the Dask cluster has had no worker for {_DESERTED:g} s; what was computed is "
                "kept, the same command goes on"
            )

    def _event(self, future: "Future") -> Event:
        order = self._orders.pop(future)
        self._fractions.pop(future.key, None)
        error = future.exception() if future.status == "error" else None
        if future.status == "cancelled":
            return Lost(order, "the scheduler")
        if error is not None:
            return Lost(order, " ".join(str(error).split()))
        answered, why = answer_of(future.result())
        if answered is None:
            return Answered(order, Refused(f"its Dask worker cannot ride: {why}"), "")
        return Answered(order, *answered)

    def _hear(self, event: Any) -> None:
        _, (key, fraction) = event
        self._fractions[key] = fraction

    def _connected(self, opening: ExitStack) -> "Client":
        from distributed import Client

        if self._scheduler is None:
            return Client(self._cluster(opening))
        try:
            return Client(self._scheduler, timeout=_CONNECTING)
        except (OSError, ValueError) as error:
            raise InputError(
                f"--scheduler {self._scheduler}: no Dask scheduler answers: "
                f"{' '.join(str(error).split())}"
            ) from error

    def _cluster(self, opening: ExitStack) -> "LocalCluster":
        from dask.config import set as configured
        from distributed import LocalCluster

        # A worker that dies is told at once, as of our own. No dashboard, and nothing else over
        # HTTP: another way into this machine. Set for as long as the cluster is there.
        settings = {"distributed.scheduler.allowed-failures": 0, _ROUTES: []}
        opening.enter_context(configured(settings))
        opening.enter_context(_without_the_current_folder())
        with _deaf_to_interrupts():
            cluster: Any = LocalCluster(
                n_workers=self._count,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address=None,  # type: ignore[arg-type]
                # Its server begins all the same: where nobody is, not on a port that may be taken.
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
                silence_logs=50,
            )
        return opening.enter_context(cluster)

    def _check_versions(self) -> None:
        """Raises InputError unless each worker that is there has our versions.

        One that comes later is asked with each batch. A scheduler only hands on.
        """
        ours = software()
        told: Any = self._client.run(*call(software), on_error="return")
        where = f"--scheduler {self._scheduler}" if self._scheduler else "--workers"
        if not told:
            raise InputError(f"{where}: has no workers yet")
        wrong = Counter(_wrong(returned, ours) for returned in told.values())
        del wrong[""]
        if wrong:
            kinds = (f"{n} of its {len(told)} workers: {what}" for what, n in sorted(wrong.items()))
            raise InputError(f"{where}: {'; '.join(kinds)}; this is {ours}")

    def _tell_repeats(self) -> None:
        """A line where the scheduler itself gives a batch again that has killed its worker."""
        with suppress(Exception):  # whether it tells, and what, is up to its version
            again: Any = self._client.run_on_scheduler(_allowed_failures())
            if again > 0:
                print(
                    f"note: this Dask scheduler gives a batch whose worker dies to {again} more "
                    "before it says so; distributed.scheduler.allowed-failures = 0 makes it one",
                    file=sys.stderr,
                )


def _wrong(returned: Any, ours: str) -> str:
    theirs, why = answer_of(returned)
    if theirs is None:
        return why
    return "" if theirs == ours else theirs


def _allowed_failures() -> Any:
    """A function for the scheduler; by its code, as `call` says."""
    return lambda dask_scheduler: dask_scheduler.allowed_failures


@contextmanager
def _without_the_current_folder() -> Iterator[None]:
    """Python processes begun inside do not seek modules in it, where a signal.py may lie.

    Dask tells its workers where this one finds its own, but only when they have begun.
    """
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Processes begun inside never hear a Ctrl-C, which is for us alone, who ask them to end.

    Threads and processes inherit what is blocked here, and so do the workers that one of these
    threads begins later, in place of one that died. We hear of it when all are there.
    """
    # Beginning it would let interrupts through again, in the very thread that begins a worker.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
