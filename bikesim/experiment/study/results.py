"""The table of an experiment's results: a row a run."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.study.manifest import EXPERIMENT, Manifest
from bikesim.experiment.study.plan import RunId, Study, make_study
from bikesim.experiment.study.reading import read_experiment
from bikesim.experiment.study.versions import Versions
from bikesim.record.output import put_in_place

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

RESULTS, TABLE = "results.parquet", "results.csv"


class Results(NamedTuple):
    """What was computed so far: `table` has a row a run, `planned` runs were asked for."""

    study: Study
    table: "pd.DataFrame"
    planned: int
    versions: Versions


def read_results(folder: Path) -> Results:
    """The results of a folder, also of one whose experiment is not done. Raises InputError."""
    manifest = Manifest.read(folder)
    study = make_study(read_experiment(str(folder / EXPERIMENT)))
    path = folder / RESULTS
    if not path.exists():
        raise InputError(f"{folder}: has no results yet")
    return Results(study, read_table(path).to_pandas(), manifest.runs, manifest.versions)


def read_table(path: Path, columns: Sequence[str] | None = None) -> "pa.Table":
    """A table of results, or some of its columns. Raises InputError."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with path.open("rb") as file:
            return pq.read_table(file, columns=None if columns is None else list(columns))
    except (OSError, pa.ArrowException) as error:
        raise InputError(
            f"{path}: cannot be read: {' '.join(str(error).split())}; remove it to ride its runs "
            "again"
        ) from error


def write_table(table: "pa.Table", path: Path) -> None:
    """A whole file, or the one before it. Raises OSError."""
    import pyarrow.parquet as pq

    with put_in_place(path) as part, part.open("wb") as file:
        pq.write_table(table, file)


def run_ids(table: "pa.Table") -> list[RunId]:
    """The run of each row."""
    columns = table["condition_number"].to_pylist(), table["seed"].to_pylist()
    return [RunId(*pair) for pair in zip(*columns, strict=True)]


def joined(tables: Sequence["pa.Table"]) -> "pa.Table":
    """All rows, each run once: a kill may leave it in a part and in the table."""
    import pyarrow as pa

    table = pa.concat_tables(tables).sort_by(
        [("condition_number", "ascending"), ("seed", "ascending")]
    )
    runs = table["run"].to_pylist()
    first = [run != before for run, before in zip(runs, [None, *runs[:-1]], strict=True)]
    return table.filter(pa.array(first, pa.bool_()))
