import os
import signal

import pytest

from bikesim.experiment.watch import Watch

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize("number", SIGNALS, ids=lambda s: s.name)
def test_a_signal_asks_for_the_end(number: int):
    with Watch(1000, 0.001).watching() as watch:
        assert watch() is False
        os.kill(os.getpid(), number)
        assert watch() is True


@pytest.mark.parametrize("number", SIGNALS, ids=lambda s: s.name)
def test_a_second_one_interrupts_at_once(monkeypatch: pytest.MonkeyPatch, number: int):
    monkeypatch.setattr("bikesim.experiment.watch._ONE_SIGNAL", -1)  # no wrapper sends it twice
    with Watch(1000, 0.001).watching():
        os.kill(os.getpid(), number)
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", SIGNALS, ids=lambda s: s.name)
def test_signals_are_given_back(number: int):
    before = signal.getsignal(number)
    with Watch(1000, 0.001).watching():
        assert signal.getsignal(number) != before
    assert signal.getsignal(number) == before


def test_a_hangup_that_is_ignored_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Watch(1000, 0.001).watching() as watch:
            os.kill(os.getpid(), signal.SIGHUP)
            assert watch() is False
    finally:
        signal.signal(signal.SIGHUP, before)


def test_progress_on_the_way_and_none_left_of_it(capsys):
    with Watch(1000, 0.001, show=True).watching() as watch:
        for _ in range(1000):
            watch()
    err = capsys.readouterr().err
    assert "1 s: " in err
    assert "1.00k" in err
    assert err.endswith("\r")


def test_none_where_nobody_looks(capsys):
    with Watch(1000, 0.001).watching() as watch:
        for _ in range(1000):
            watch()
    assert capsys.readouterr() == ("", "")
