"""The folder of an experiment's results: who may write there, and how nothing gets lost."""

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from bikesim.errors import InputError
from bikesim.experiment.study.columns import schema_of, table_of
from bikesim.experiment.study.manifest import (
    EXPERIMENT,
    MANIFEST,
    Manifest,
    changed_file,
    difference,
    to_toml,
    write_text,
)
from bikesim.experiment.study.plan import RunId, Study
from bikesim.experiment.study.results import (
    RESULTS,
    TABLE,
    joined,
    read_table,
    run_ids,
    write_table,
)
from bikesim.record.output import put_in_place, unwritable

if TYPE_CHECKING:
    import pyarrow as pa

    from bikesim.experiment.study.work import Done

PARTS, RECORDS, VIDEOS = "parts", "records", "videos"
_LOCK = ".lock"
_IDS = ("condition_number", "seed")
# The manifest last: a folder that is half emptied is still known as one of ours.
_OURS = (
    EXPERIMENT, RESULTS, TABLE, PARTS, RECORDS, VIDEOS,
    "report.html", "statistics.json", "figures", MANIFEST,
)  # fmt: skip


@contextmanager
def open_folder(path: Path, study: Study, *, force: bool) -> Iterator["ResultsFolder"]:
    """The results of this study, for this process alone. Raises InputError.

    A folder with those of another experiment is refused, or emptied with `force`.
    """
    manifest = Manifest.of(study)
    _refuse_others(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        lock = os.open(path / _LOCK, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise unwritable(path, error) from error
    try:
        _take(path, lock)
        if force:
            _clear(path)
        folder = ResultsFolder(path, study)
        begun = (path / MANIFEST).exists()
        if begun:
            _refuse_changes(path, study, manifest, done=len(folder.done) == study.runs)
        else:
            manifest.write(path)
        write_text(path / EXPERIMENT, to_toml(study.experiment))
        yield folder
    finally:
        os.close(lock)


def is_done(path: Path, study: Study) -> bool:
    """Whether a folder has a row for each run of a study; whose they are is not asked."""
    with suppress(InputError):
        table = path / RESULTS
        return table.is_file() and set(study.ids()) <= set(run_ids(read_table(table, _IDS)))
    return False


class ResultsFolder:
    """Takes results and puts them into parts, then into one table; each part whole or not there."""

    def __init__(self, path: Path, study: Study) -> None:
        self.path, self._study = path, study
        self._schema = schema_of(study)
        self.done = self._find_done()

    def add(self, batch: int, done: "Done", worker: str) -> None:
        """Keep what came of a batch. Raises InputError, with what is kept, if it cannot."""
        table = table_of(batch, done, worker, self._study, self._schema)
        if not len(table):
            return
        path = self.path / PARTS / f"{self._next_part():06d}.parquet"
        try:
            path.parent.mkdir(exist_ok=True)
            write_table(table, path)
        except OSError as error:
            raise unwritable(path, error, self.kept()) from error
        self.done.update(run_ids(table))

    def kept(self) -> str:
        """For an error: what is not lost."""
        return (
            f"; {len(self.done)} of {self._study.runs} runs are kept in {self.path}, "
            "the same command goes on"
        )

    def merge(self) -> None:
        """One table of all parts, in the order of conditions and seeds. Raises InputError."""
        import pyarrow.csv  # a module of its own

        parts = self._parts()
        kept = [path for path in (self.path / RESULTS, *parts) if path.exists()]
        if not kept:
            return
        table = self._linked(joined([read_table(path) for path in kept]))
        try:
            write_table(table, self.path / RESULTS)
            with put_in_place(self.path / TABLE) as part:
                pyarrow.csv.write_csv(_gaps_empty(table), part)
        except OSError as error:
            raise unwritable(self.path / RESULTS, error, self.kept()) from error
        for part in parts:
            part.unlink(missing_ok=True)
        with suppress(OSError):
            (self.path / PARTS).rmdir()

    def record(self, run: RunId) -> Path:
        """Where a run's record lies, if it is kept."""
        return self.path / RECORDS / f"{self._study.file_name(run)}.h5"

    def video(self, run: RunId) -> Path:
        """Where a run's video lies, if it is filmed."""
        return self.path / VIDEOS / f"{self._study.file_name(run)}.mp4"

    def _linked(self, table: "pa.Table") -> "pa.Table":
        """The table with the records and videos that are there now."""
        import pyarrow as pa

        runs = run_ids(table)
        for name, place in (("record", self.record), ("video", self.video)):
            there = set((self.path / f"{name}s").glob("*"))
            paths = [path if there and (path := place(run)) in there else None for run in runs]
            links = [None if path is None else f"{name}s/{path.name}" for path in paths]
            column = table.schema.get_field_index(name)
            table = table.set_column(column, name, pa.array(links, pa.string()))
        return table

    def _parts(self) -> list[Path]:
        return sorted((self.path / PARTS).glob("*.parquet"))

    def _next_part(self) -> int:
        return max((int(part.stem) for part in self._parts()), default=0) + 1

    def _find_done(self) -> set[RunId]:
        done = set[RunId]()
        for path in (self.path / RESULTS, *self._parts()):
            if path.exists():
                done.update(run_ids(read_table(path, _IDS)))
        return done


def _gaps_empty(table: "pa.Table") -> "pa.Table":
    """For text: a figure that is not defined leaves its cell empty."""
    import numpy as np
    import pyarrow as pa

    def emptied(column: "pa.ChunkedArray") -> "pa.Array":
        values = column.to_numpy()
        return pa.array(values, mask=np.isnan(values))

    floating = pa.types.is_floating
    columns = [emptied(one) if floating(one.type) else one for one in table.columns]
    return pa.table(columns, names=table.column_names)


def _clear(path: Path) -> None:
    """Remove what an experiment leaves, and nothing else."""
    try:
        for name in _OURS:
            place = path / name
            if place.is_dir() and not place.is_symlink():
                shutil.rmtree(place)
            else:
                place.unlink(missing_ok=True)
    except OSError as error:
        raise unwritable(path, error) from error


def _refuse_others(path: Path) -> None:
    """Not a place where results can be, or somebody's files."""
    try:
        if path.exists() and not path.is_dir():
            raise InputError(f"{path}: is not a folder; give the name of one")
        if not path.exists() or (path / MANIFEST).exists():
            return
        if others := sorted(p.name for p in path.iterdir() if not p.name.startswith(".")):
            raise InputError(
                f"{path}: holds no experiment's results, but {others[0]}; give another with -o"
            )
    except OSError as error:
        raise unwritable(path, error) from error


def _refuse_changes(path: Path, study: Study, now: Manifest, *, done: bool) -> None:
    """Results of another experiment, or of other software if there are more to come."""
    before = Manifest.read(path)
    if before.digest != now.digest or changed_file(before.files, now.files):
        raise InputError(
            f"{path}: holds the results of another experiment: {_what(path, study, before, now)}; "
            "give another folder with -o, or --force to begin anew"
        )
    if before.versions != now.versions and not done:
        raise InputError(
            f"{path}: was begun with {before.software}, this is {now.software}; "
            "give another folder with -o, or --force to begin anew"
        )


def _what(path: Path, study: Study, before: Manifest, now: Manifest) -> str:
    with suppress(OSError):
        old = (path / EXPERIMENT).read_text("utf-8")
        if told := difference(old, to_toml(study.experiment)):
            return told
    if name := changed_file(before.files, now.files):
        return f"{name} has changed"
    if before.versions != now.versions:
        return f"its scenarios mean something else under {now.versions} than {before.versions}"
    return "its scenarios mean something else in this version of the source"


def _take(path: Path, lock: int) -> None:
    try:
        fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError(f"{path}: another bikesim is working on it") from None
    except OSError:
        return  # a file system without locks
