"""Which runs leave a full record, and which of those a video."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bikesim.experiment.study.plan import RunId, Study
from bikesim.experiment.study.settings import Kept

if TYPE_CHECKING:
    import pandas as pd


def runs_to_keep(study: Study, table: "pd.DataFrame") -> list[RunId]:
    """Those of the results table that the experiment keeps, as many as it may.

    By seed, then by condition: where not all can be kept, each condition has its share.
    """
    asked = study.experiment
    return _chosen(study, table, asked.keep)[: asked.keep_limit]


def runs_to_film(study: Study, table: "pd.DataFrame", kept: Sequence[RunId]) -> list[RunId]:
    """Those of the kept runs that are filmed."""
    asked = study.experiment
    of_kept = set(kept)
    chosen = [run for run in _chosen(study, table, asked.videos) if run in of_kept]
    return chosen[: asked.video_limit]


def _chosen(study: Study, table: "pd.DataFrame", which: Kept) -> list[RunId]:
    seeds = {seed: i for i, seed in enumerate(study.experiment.seeds)}
    rows = zip(table["condition_number"], table["seed"], table["fell"], strict=True)
    chosen = [
        RunId(int(number), int(seed))
        for number, seed, fell in rows
        if which == "all" or (which == "falls" and fell) or (which == "first" and not seeds[seed])
    ]
    return sorted(chosen, key=lambda run: (seeds[run.seed], run.condition))
