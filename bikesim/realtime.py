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


class Granted(NamedTuple):
    """What was granted: None, else why not, in words for the user."""

    scheduling: str | None
    memory_lock: str | None
    timer_slack: str | None
    own_processor: str | None

    @property
    def everything(self) -> bool:
        """Whether nothing was refused."""
        return self == (None, None, None, None)


def processors() -> set[int]:
    """Those that this thread may use; empty where the system does not say."""
    ask = getattr(os, "sched_getaffinity", None)
    return set() if ask is None else ask(0)


@contextmanager
def real_time(priority: int = PRIORITY, *, processor: int = -1) -> Iterator[Granted]:
    """Runs its body under SCHED_FIFO on one processor, memory locked, without garbage collection.

    Each as far as it is permitted; all are given back at the end. Objects that exist at the start
    are never looked at by the collector again, and it does not run in between: a loop makes no
    cycles of objects, so nothing piles up.

    `processor` of those that this thread may use, in order, the last by default. Two loops that
    share one are stopped by the kernel, for up to 50 ms, when together they leave too little of it
    to others (sched_rt_runtime_us). Threads that the body begins are bound to it too.
    """
    policy, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
    usable = processors()
    slack = _libc().prctl(_PR_GET_TIMERSLACK, 0, 0, 0, 0)
    collecting = gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    scheduled = _schedule(priority)
    own = _bind(usable, processor) if scheduled is None else "it needs real-time scheduling"
    granted = Granted(scheduled, _lock_memory(), _set_timer_slack(1), own)
    try:
        yield granted
    finally:
        if granted.scheduling is None:
            os.sched_setscheduler(0, policy, parameter)
        if granted.own_processor is None:
            os.sched_setaffinity(0, usable)
        if granted.memory_lock is None:
            _libc().munlockall()
        if slack > 0:
            _set_timer_slack(slack)
        gc.unfreeze()
        if collecting:
            gc.enable()


def _schedule(priority: int) -> str | None:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError) as error:
        return _reason(error, "it needs CAP_SYS_NICE, or rtprio in limits.conf")
    return None


def _bind(usable: set[int], index: int) -> str | None:
    if len(usable) < 2:
        return "there is only one"
    try:
        os.sched_setaffinity(0, {sorted(usable)[index]})
    except OSError as error:
        return _reason(error, "the system does not let it choose")
    return None


def _lock_memory() -> str | None:
    if _libc().mlockall(_MCL_CURRENT | _MCL_FUTURE) != 0:
        error = OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
        return _reason(error, "it needs CAP_IPC_LOCK, or memlock in limits.conf")
    return None


def _set_timer_slack(nanoseconds: int) -> str | None:
    if _libc().prctl(_PR_SET_TIMERSLACK, nanoseconds, 0, 0, 0) != 0:
        return os.strerror(ctypes.get_errno())
    return None


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _reason(error: Exception, what_helps: str) -> str:
    said = error.strerror if isinstance(error, OSError) else str(error)
    return f"{said}: {what_helps}"
