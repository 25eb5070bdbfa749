"""What the operating system may grant a loop that must be on time; what it does not is said."""

import ctypes
import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

# Above ordinary work, below the kernel's own threads (interrupts run at 50).
PRIORITY = 40

_MCL_CURRENT, _MCL_FUTURE = 1, 2
_PR_SET_TIMERSLACK, _PR_GET_TIMERSLACK = 29, 30

_NOT_HERE = "not to be had on this system"


class Granted(NamedTuple):
    """What was granted: None, else why not, in words for the user."""

    scheduling: str | None
    memory_lock: str | None
    timer_slack: str | None

    @property
    def everything(self) -> bool:
        """Whether nothing was refused."""
        return self == (None, None, None)


@contextmanager
def real_time(priority: int = PRIORITY) -> Iterator[Granted]:
    """Runs its body under SCHED_FIFO, its memory locked, without garbage collection.

    Each as far as it is permitted; all are given back at the end. Objects that exist at the start
    are never looked at by the collector again, and it does not run in between: a loop makes no
    cycles of objects, so nothing piles up.
    """
    before = _scheduling()
    slack = _called("prctl", _PR_GET_TIMERSLACK, 0, 0, 0, 0)
    collecting = gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    granted = Granted(_schedule(priority), _lock_memory(), _set_timer_slack(1))
    try:
        yield granted
    finally:
        if granted.scheduling is None and before is not None:
            os.sched_setscheduler(0, *before)
        if granted.memory_lock is None:
            _called("munlockall")
        if slack is not None and slack > 0:
            _set_timer_slack(slack)
        gc.unfreeze()
        if collecting:
            gc.enable()


def _scheduling() -> "tuple[int, os.sched_param] | None":
    """As it is; None where the system has none to choose from (macOS, Windows)."""
    if not hasattr(os, "sched_setscheduler"):
        return None
    return os.sched_getscheduler(0), os.sched_getparam(0)


def _schedule(priority: int) -> str | None:
    if not hasattr(os, "sched_setscheduler"):
        return f"real-time scheduling is {_NOT_HERE}"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        return _reason(error, "it needs CAP_SYS_NICE, or rtprio in limits.conf")
    return None


def _lock_memory() -> str | None:
    locked = _called("mlockall", _MCL_CURRENT | _MCL_FUTURE)
    if locked is None:
        return _NOT_HERE
    if locked != 0:
        error = OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
        return _reason(error, "it needs CAP_IPC_LOCK, or memlock in limits.conf")
    return None


def _set_timer_slack(nanoseconds: int) -> str | None:
    done = _called("prctl", _PR_SET_TIMERSLACK, nanoseconds, 0, 0, 0)
    if done is None:
        return _NOT_HERE
    return os.strerror(ctypes.get_errno()) if done != 0 else None


def _called(name: str, *arguments: int) -> int | None:
    """What a function of the C library says; None where there is none of this name."""
    try:
        function = getattr(_libc(), name)
    except (AttributeError, OSError, TypeError):  # TypeError: Windows has no library of no name
        return None
    return function(*arguments)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _reason(error: OSError, what_helps: str) -> str:
    return f"{error.strerror}: {what_helps}"
