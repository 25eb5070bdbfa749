"""A claim of the paper beside what we compute: as JSON, and as a table of 100 columns."""

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

_WIDTHS = (42, 23, 24, 5)
_HEADER = ("claim", "paper", "ours", "holds")
_NOTE_WIDTH = 94


@dataclass(frozen=True)
class Claim:
    """What is claimed, the paper's figure or words, ours, and whether the claim holds as stated.

    `paper` is None where the claim is not in the paper; `ours` is computed in this run.
    """

    claim: str
    paper: float | str | None
    ours: float | str
    holds: bool
    note: str = ""

    def as_json(self) -> dict[str, Any]:
        """One entry of `bikesim paper --json`."""
        return {
            "claim": self.claim,
            "paper": self.paper,
            "ours": self.ours,
            "holds": bool(self.holds),  # not numpy's
            "note": self.note,
        }


def agrees(ours: float, printed: str) -> bool:
    """Whether a value rounds to the digits that are printed."""
    decimals = len(printed.partition(".")[2])
    return abs(ours - float(printed)) <= 0.5 * 10.0**-decimals


def told(claims: Sequence[Claim]) -> str:
    """The claims as a table, notes below."""
    lines = [_row(_HEADER), "  ".join("-" * width for width in _WIDTHS)]
    for claim in claims:
        lines += _told(claim)
    held = sum(claim.holds for claim in claims)
    return "\n".join([*lines, "", f"{held} of {len(claims)} claims hold as stated"])


def _told(claim: Claim) -> Iterator[str]:
    words = (claim.claim, _word(claim.paper), _word(claim.ours), "yes" if claim.holds else "NO")
    columns = [textwrap.wrap(word, width) for word, width in zip(words, _WIDTHS, strict=True)]
    yield from (_row(cells) for cells in zip_longest(*columns, fillvalue=""))
    yield from textwrap.wrap(
        claim.note, _NOTE_WIDTH, initial_indent="    ", subsequent_indent="    "
    )


def _row(cells: Sequence[str]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, _WIDTHS, strict=True)).rstrip()


def _word(value: float | str | None) -> str:
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.10g}"
