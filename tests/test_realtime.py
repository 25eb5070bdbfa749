import ctypes
import gc
import os

import pytest

from bikesim.realtime import Granted, real_time


def test_it_says_for_each_whether_it_was_granted_and_the_system_agrees():
    with real_time(priority=7) as granted:
        fifo = os.sched_getscheduler(0) == os.SCHED_FIFO
        assert (granted.scheduling is None) == fifo
        if fifo:
            assert os.sched_getparam(0).sched_priority == 7
        for refusal in granted:
            assert refusal is None or len(refusal) > 10
        assert granted.everything == (granted == Granted(None, None, None))


def test_the_collector_rests_meanwhile_and_all_is_given_back():
    policy = os.sched_getscheduler(0)
    assert gc.isenabled()
    with real_time():
        assert not gc.isenabled()
        assert gc.get_freeze_count() > 0
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0
    assert os.sched_getscheduler(0) == policy


def test_it_is_given_back_after_an_exception_too():
    try:
        with real_time():
            raise RuntimeError
    except RuntimeError:
        pass
    assert gc.isenabled()


def no_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("getscheduler", "setscheduler", "getparam"):
        monkeypatch.delattr(os, f"sched_{name}")
    monkeypatch.delattr(os, "SCHED_FIFO")
    monkeypatch.delattr(os, "sched_param")


class WithoutPrctl:
    """The C library of macOS: memory locks, but no prctl."""

    def __init__(self, *arguments: object, **more: object) -> None: ...

    def mlockall(self, flags: int) -> int:
        return 0

    def munlockall(self) -> int:
        return 0


def test_on_a_system_without_any_of_it_that_is_said(monkeypatch: pytest.MonkeyPatch):
    """As on Windows, where no library has no name."""

    def no_library(name: str | None, **more: object) -> None:
        raise TypeError("argument of type 'NoneType' is not iterable")

    no_scheduler(monkeypatch)
    monkeypatch.setattr(ctypes, "CDLL", no_library)
    with real_time() as granted:
        assert not gc.isenabled()
    assert gc.isenabled()
    assert "real-time scheduling is not to be had on this system" in str(granted.scheduling)
    assert granted.memory_lock == granted.timer_slack == "not to be had on this system"


def test_what_a_system_has_is_granted(monkeypatch: pytest.MonkeyPatch):
    no_scheduler(monkeypatch)
    monkeypatch.setattr(ctypes, "CDLL", WithoutPrctl)
    with real_time() as granted:
        pass
    assert granted.memory_lock is None
    assert granted.timer_slack == "not to be had on this system"
