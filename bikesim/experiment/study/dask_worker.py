"""What the workers of a Dask cluster run, also those who have no bikesim, or another one."""

import hashlib
import pickle
from collections.abc import Callable
from typing import Any

from bikesim.experiment.study.versions import Versions
from bikesim.experiment.study.work import Answer, Order, work

TOPIC = "bikesim-progress"
"""Of the events that tell the fraction of an order that is done: (key of the task, fraction)."""

Call = tuple[Callable[[bytes], bytes | str], bytes]


def call(function: Callable[..., Any], *arguments: Any) -> Call:
    """A function to be called there with one argument; `answer_of` reads what it returns.

    It goes there by its code, not by its name, and all of ours is bytes in it: a scheduler needs no
    bikesim, and a worker without one says so. By name it would close its connection, again and
    again, as if the batch had killed it.
    """

    def unpack_and_call(packed: bytes) -> bytes | str:
        import pickle

        try:
            function, arguments = pickle.loads(packed)
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return pickle.dumps(function(*arguments))

    return unpack_and_call, pickle.dumps((function, arguments))


def answer_of(returned: Any) -> tuple[Any, str]:
    """What the function returned there; or None, and in one line why it could not be called."""
    if isinstance(returned, bytes):
        return pickle.loads(returned), ""
    told = f"{type(returned).__name__}: {returned}" if _raised(returned) else str(returned)
    return None, " ".join(told.split())


def software() -> str:
    """The versions that the worker has."""
    return str(Versions.gather())


def do(order: Order) -> tuple[Answer, str]:
    """The answer to an order, and the name of the worker who gave it."""
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()

    def report(fraction: float) -> bool:
        worker.log_event(TOPIC, (key, fraction))
        task = worker.state.tasks.get(key)
        # Whoever asked for it has gone, or wants it no more.
        return task is None or task.state == "cancelled"

    # Not its address: a table of results should not name machines.
    name = hashlib.sha256(worker.address.encode()).hexdigest()[:6]
    return work(order, report), f"dask-{name}"


def _raised(returned: Any) -> bool:
    # Dask makes one of its own of an exception's text.
    return isinstance(returned, BaseException) and type(returned) is not Exception
