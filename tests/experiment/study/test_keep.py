"""Which runs leave a record, and which of those a video."""

import pandas as pd
import pytest

from bikesim.experiment.study.keep import runs_to_film, runs_to_keep
from bikesim.experiment.study.plan import RunId

# Seed 1 falls in condition 1 and 2, seed 2 in condition 2 only.
TABLE = pd.DataFrame(
    {
        "condition_number": [1, 1, 2, 2],
        "seed": [1, 2, 1, 2],
        "fell": [1.0, 0.0, 1.0, 1.0],
    }
)


def study(make, *lines: str):
    return make("seeds = 2\n" + "\n".join(lines) + "\nfactors.law = ['paper', 'off']\n")


@pytest.mark.parametrize(
    ("keep", "limit", "expected"),
    [
        ("none", 100, []),
        ("first", 100, [(1, 1), (2, 1)]),
        ("falls", 100, [(1, 1), (2, 1), (2, 2)]),
        ("all", 100, [(1, 1), (2, 1), (1, 2), (2, 2)]),
        ("all", 3, [(1, 1), (2, 1), (1, 2)]),
        ("falls", 0, []),
    ],
)
def test_runs_to_keep(make, keep, limit, expected):
    asked = study(make, f"keep = '{keep}'", f"keep_limit = {limit}")
    assert runs_to_keep(asked, TABLE) == [RunId(*pair) for pair in expected]


def test_only_what_is_kept_is_filmed(make):
    asked = study(make, "keep = 'falls'", "videos = 'all'", "video_limit = 2")
    kept = runs_to_keep(asked, TABLE)
    assert runs_to_film(asked, TABLE, kept) == [RunId(1, 1), RunId(2, 1)]
    assert runs_to_film(asked, TABLE, []) == []
