"""Which runs ride together."""

import pytest

from bikesim.experiment.study.plan import RunId, _shares


def test_every_run_is_in_one_batch(small):
    batches = list(small.batches(set(), size=2, workers=2))
    runs = [run for batch in batches for run in batch.runs]
    assert sorted(runs) == sorted(small.ids())
    assert len(runs) == len(set(runs)) == 12


def test_a_batch_of_long_runs_is_smaller(make):
    """512 MiB of signals: of 16 at 100 Hz for an hour, 46.1 MB a run: 11 fit, 10 a share."""
    study = make("seeds = 100\nscenario.duration = 3600.0\n")
    assert max(len(batch.runs) for batch in study.batches(set(), 512, 1)) == 10


def test_a_batch_has_no_more_than_asked(small):
    assert max(len(batch.runs) for batch in small.batches(set(), size=5, workers=2)) <= 5


def test_what_is_done_is_left_out(small):
    done = {RunId(1, 1), RunId(4, 3)}
    runs = {run for batch in small.batches(done, 512, 2) for run in batch.runs}
    assert runs == set(small.ids()) - done


def test_conditions_that_cannot_ride_together_do_not(small):
    for batch in small.batches(set(), 512, 1):
        assert len({small.condition(run.condition).scenario.law for run in batch.runs}) == 1


def test_longer_runs_go_first(make):
    study = make("seeds = 1\nfactors.time = { key = 'duration', values = [1, 3, 2] }")
    batches = study.batches(set(), 512, 1)
    durations = [study.condition(b.runs[0].condition).scenario.duration for b in batches]
    assert durations == [3, 2, 1]


@pytest.mark.parametrize(
    ("runs", "size", "workers", "expected"),
    [
        (0, 512, 2, []),
        (10, 512, 2, [10]),  # too few to share
        (1000, 512, 2, [500, 500]),
        (600, 512, 4, [150] * 4),
        (100, 30, 2, [25] * 4),
        (1100, 512, 2, [275] * 4),  # not 367 to the one and 733 to the other
        (12600, 600, 2, [600] * 21),  # so many that the last one does not matter
    ],
)
def test_workers_get_equal_shares(runs, size, workers, expected):
    shares = [last - first for first, last in _shares(runs, size, workers)]
    assert sum(shares) == runs
    assert sorted(shares) == sorted(expected)


def test_a_file_name_sorts_as_the_table_and_has_no_odd_sign(make):
    study = make("seeds = 1\n[[conditions]]\nname = 'a/b: c d'\nset = {}\n")
    assert study.file_name(RunId(1, 7)) == "1-a-b-c-d-seed7"
