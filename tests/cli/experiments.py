"""An experiment of many batches, and tables of results as tests compare them."""

from pathlib import Path

import pyarrow.parquet as pq

from bikesim.experiment.study.columns import PROVENANCE

# Some seconds in twenty batches.
MANY = """
seeds = 20
batch_size = 2
[scenario]
duration = 1.0
[factors]
law = ["paper", "off"]
"""


def rows(folder: Path) -> list[dict[str, str]]:
    """The table but for who computed it."""
    table = pq.read_table(folder / "results.parquet").drop_columns(list(PROVENANCE))
    # What is not defined equals itself as text only.
    return [{name: repr(value) for name, value in row.items()} for row in table.to_pylist()]
