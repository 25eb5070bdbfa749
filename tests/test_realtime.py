import gc
import os

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
