"""Claims as JSON and as a table."""

import json

import numpy as np
import pytest

from bikesim.report.paper.claims import Claim, agrees, told


@pytest.mark.parametrize(
    ("ours", "printed", "expected"),
    [
        (0.231085011733, "0.23108501173", True),
        (4.30097, "4.3010", True),
        (4.30104, "4.3010", True),
        (4.30106, "4.3010", False),
        (-2.1632, "-2.1632", True),
        (81.4, "81", True),
        (81.6, "81", False),
    ],
)
def test_agrees_with_the_digits_that_are_printed(ours: float, printed: str, expected: bool):
    assert agrees(ours, printed) is expected


def test_json_has_the_five_keys_and_plain_values():
    claim = Claim("c", None, 1.5, holds=np.bool_(True), note="n")  # type: ignore[arg-type]
    entry = json.loads(json.dumps(claim.as_json()))
    assert entry == {"claim": "c", "paper": None, "ours": 1.5, "holds": True, "note": "n"}


def test_the_table_is_at_most_100_columns_wide():
    long = "a long sentence about weave, capsize and castering " * 6
    text = told([Claim(long, long, long, holds=False, note=long)])
    assert max(len(line) for line in text.splitlines()) <= 100


def test_the_table_counts_what_holds():
    claims = [Claim("a", "1", 1.0, holds=True), Claim("b", "2", 3.0, holds=False)]
    assert told(claims).endswith("1 of 2 claims hold as stated")


def test_the_table_shows_a_claim_that_does_not_hold():
    line = told([Claim("b", "2", 3.0, holds=False)]).splitlines()[2]
    assert line.split() == ["b", "2", "3", "NO"]
