import pytest

from bikesim.bench.continuity import Continuity, Flaw, Passage


def follow(sent: list[tuple[int, float]], came: list[float]) -> list[Passage | Flaw]:
    """For counters and node times [s] as they were sent, and when they came [s]."""
    continuity = Continuity(1e-3)
    return [
        continuity.follow(counter, round(time * 1e5) % 65536, arrival)
        for (counter, time), arrival in zip(sent, came, strict=True)
    ]


def frames(numbers: list[int]) -> list[Passage | Flaw]:
    """For the n-th frames of a node, without delay."""
    return follow([(n % 15, n * 1e-3) for n in numbers], [n * 1e-3 for n in numbers])


def lost(told: list[Passage | Flaw]) -> list[int]:
    return [one.lost for one in told if isinstance(one, Passage)]


def test_time_goes_on_when_both_wrap_around():
    told = frames(list(range(2000)))
    assert [one.time for one in told if isinstance(one, Passage)] == pytest.approx(
        [n * 1e-3 for n in range(2000)]
    )
    assert set(lost(told)) == {0}


@pytest.mark.parametrize("gap", [1, 2, 13, 14, 15, 29, 30, 100, 700, 3000])
def test_frames_that_are_missing_are_counted(gap: int):
    """Fifteen missing bring the same counter again; 656 ms the same time."""
    assert lost(frames([0, 1, 2 + gap])) == [0, 0, gap]


@pytest.mark.parametrize("pause", [x * 1e-4 for x in range(11, 650, 3)])
@pytest.mark.parametrize("ahead", [0.0, 3.217, -5000.0])
def test_a_node_that_paused_goes_on(pause: float, ahead: float):
    """It counts the frames that it sends: after a pause the next number, at a later time."""
    times = [n * 1e-3 for n in range(50)]
    times += [times[-1] + pause + n * 1e-3 for n in range(50)]
    told = follow([(n % 15, t) for n, t in enumerate(times)], [t + ahead for t in times])
    seen = [one.time for one in told if isinstance(one, Passage)]
    assert seen == pytest.approx([round(t * 1e5) * 1e-5 for t in times])


def test_a_frame_that_comes_again_is_repeated():
    assert frames([0, 1, 1, 2])[2] is Flaw.REPEATED


def test_a_counter_that_stands_still_is_not_taken_for_a_gap():
    told = follow([(3, n * 1e-3) for n in range(100)], [n * 1e-3 for n in range(100)])
    assert told[1:] == [Flaw.REPEATED] * 99


def test_a_time_that_stands_still_is_frozen():
    told = follow([(n % 15, 0.2) for n in range(100)], [n * 1e-3 for n in range(100)])
    assert told[1:] == [Flaw.FROZEN] * 99


def test_a_frame_overtaken_by_a_later_one_is_frozen():
    assert frames([0, 1, 3, 2])[3] is Flaw.FROZEN


def test_frames_that_come_late_are_good():
    sent = [(n % 15, n * 1e-3) for n in range(6)]
    told = follow(sent, [0.0, 0.001, 0.3, 0.3, 0.3, 0.3])
    assert lost(told) == [0] * 6


@pytest.mark.parametrize("period", [1e-3, 1e-2], ids=["node", "wheel"])
@pytest.mark.parametrize("stall", [0.02, 0.2, 0.34, 0.5, 0.7, 0.9, 1.3])
@pytest.mark.parametrize("room", [1, 10, 40, 200])
def test_a_buffer_that_was_full(period: float, stall: float, room: int):
    """The host does not read for a while; of what came meanwhile its buffer kept the oldest."""
    begin, end = round(1.0 / period), round((1.0 + stall) / period)
    kept = range(begin, min(begin + room, end))
    numbers = [*range(begin), *kept, *range(end, end + 700)]
    came = [n * period if n not in kept else end * period for n in numbers]
    continuity = Continuity(period)
    told = [
        continuity.follow(n % 15, round(n * period * 1e5) % 65536, arrival)
        for n, arrival in zip(numbers, came, strict=True)
    ]
    assert [one for one in told if isinstance(one, Flaw)] == []
    assert lost(told)[begin + len(kept)] == end - begin - len(kept)
    assert sum(lost(told)) == end - begin - len(kept)
    assert isinstance(told[-1], Passage)
    assert told[-1].time == pytest.approx(numbers[-1] * period)


def test_a_clock_that_jumps_back_is_a_flaw_once():
    sent = [(n % 15, (n if n < 50 else n - 20) * 1e-3) for n in range(100)]
    told = follow(sent, [n * 1e-3 for n in range(100)])
    assert [i for i, one in enumerate(told) if isinstance(one, Flaw)] == [50]


@pytest.mark.parametrize("counter", range(15))
@pytest.mark.parametrize("ticks", [0, 1, 100, 65535])
def test_before_the_first_frame_none_is_missing(counter: int, ticks: int):
    told = Continuity(1e-3).follow(counter, ticks, 0.0)
    assert told == Passage(ticks * 1e-5, 0)
