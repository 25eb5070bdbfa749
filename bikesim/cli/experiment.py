"""bikesim experiment"""

import sys
from collections.abc import Set
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.output import print_json
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.experiment.study.conduct import Conducted
    from bikesim.experiment.study.crew import Crew
    from bikesim.experiment.study.folder import ResultsFolder
    from bikesim.experiment.study.plan import Batch, RunId, Study


def _arg(metavar: str, text: str, *aliases: str) -> Any:
    return tyro.conf.arg(metavar=metavar, help=text, help_behavior_hint="", aliases=list(aliases))


@dataclass(frozen=True)
class Experiment:
    """Ride many runs: conditions times seeds, on all cores; a table, statistics and a report.

    Begun again with the same file and folder it computes what is missing. Without a FILE it lists
    the experiments that ship.
    """

    file: Annotated[
        str | None,
        tyro.conf.Positional,
        _arg("[FILE.toml|NAME]", "An experiment's file, or one that ships by its name."),
    ] = None
    output: Annotated[
        Path | None,
        _arg("FOLDER", "Of the results (default: runs/ with the file's name).", "-o"),
    ] = None
    jobs: Annotated[int | None, _arg("INT", "Processes that ride (default: one a core).", "-j")] = (
        None
    )
    workers: Annotated[
        int | None, _arg("INT", "Instead of these, a local Dask cluster of so many workers.")
    ] = None
    scheduler: Annotated[
        str | None, _arg("URL", "Instead of these, the Dask cluster there: tcp://HOST:PORT.")
    ] = None
    batch_size: Annotated[
        int | None, _arg("INT", "Runs ridden together, at most (default: what the file says).")
    ] = None
    dry_run: Flag = False
    """Ride nothing; say which conditions, how many runs and batches, and how long it would take."""
    no_report: Flag = False
    """Leave out the report."""
    force: Flag = False
    """Begin anew: remove the results that are in the folder."""
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        if self.file is None:
            return self._list()
        self._check()
        folder = self.output or Path("runs") / Path(self.file).stem
        study = self._study(self.file, folder)
        if self.dry_run:
            return self._tell_plan(study)
        return self._conduct(study, folder)

    def _check(self) -> None:
        for name in ("jobs", "workers", "batch_size"):
            value = getattr(self, name)
            if value is not None and not 1 <= value <= 65536:
                raise InputError(f"--{name.replace('_', '-')} {value}: must be at least 1")
        if sum(one is not None for one in (self.jobs, self.workers, self.scheduler)) > 1:
            raise InputError("--jobs, --workers, --scheduler: one of them at a time")

    def _list(self) -> int:
        from bikesim.experiment.study.reading import read_experiment, shipped_names

        titles = {name: read_experiment(name).title for name in shipped_names()}
        if self.json:
            print_json(titles)
            return 0
        width = max(map(len, titles), default=0)
        for name, title in titles.items():
            print(f"{name.ljust(width)}  {title}")
        return 0

    def _study(self, file: str, folder: Path) -> "Study":
        from bikesim.experiment.study.check import check_conditions
        from bikesim.experiment.study.estimate import seconds_for_many, told
        from bikesim.experiment.study.folder import is_done
        from bikesim.experiment.study.plan import TooManyError, make_study
        from bikesim.experiment.study.reading import read_experiment
        from bikesim.textfile import located

        experiment = read_experiment(file)
        with located(f"experiment {file}"):
            try:
                study = make_study(experiment)
            except TooManyError as error:
                size = self._size(experiment)
                seconds = seconds_for_many(error.scenario, error.runs, size, self._n)
                raise InputError(f"{error}; they would take {told(seconds)}") from None
            # To report what is done takes no rider.
            if self.dry_run or self.force or not is_done(folder, study):
                check_conditions(study)
            return study

    def _size(self, experiment: Any) -> int:
        return self.batch_size or experiment.batch_size

    @property
    def _n(self) -> int:
        from bikesim.experiment.study.crew import cores

        return self.workers or self.jobs or cores()

    def _batches(self, study: "Study", done: "Set[RunId]", workers: int) -> "list[Batch]":
        return list(study.batches(done, self._size(study.experiment), workers))

    def _tell_plan(self, study: "Study") -> int:
        from bikesim.cli.experiment_telling import plan_json, plan_told
        from bikesim.experiment.study.estimate import seconds_for

        if self.scheduler is not None:
            raise InputError("--dry-run: looks at this machine only; leave --scheduler out")
        batches = self._batches(study, set(), self._n)
        seconds = seconds_for(study, batches, self._n)
        if self.json:
            print_json(plan_json(study, batches, self._n, seconds))
        else:
            print(plan_told(study, batches, self._n, seconds))
        return 0

    def _conduct(self, study: "Study", path: Path) -> int:
        from bikesim.experiment.study.folder import open_folder

        with open_folder(path, study, force=self.force) as folder:
            try:
                conducted = self._ride(study, folder)
            finally:
                # What was computed makes a table, however it ended.
                folder.merge()
            report = None
            if conducted.whole:
                self._film(study, folder)
                report = self._report(folder)
            self._tell(folder, report)
        return self._status(folder, conducted)

    def _ride(self, study: "Study", folder: "ResultsFolder") -> "Conducted":
        from bikesim.experiment.study.conduct import (
            Conducted,
            ride_batches,
            ride_kept,
            try_riders,
        )
        from bikesim.experiment.study.crew import LocalCrew
        from bikesim.experiment.watch import Watch

        with Watch(1, 1.0, show=False).watching() as watch:
            conducted = Conducted(True, ())
            if len(folder.done) < study.runs:
                with self._crew() as crew:
                    tried = try_riders(study, crew, watch)
                    if not tried.whole:
                        return tried
                    batches = self._batches(study, folder.done, crew.workers)
                    self._announce(study, folder, batches, crew.workers)
                    conducted = ride_batches(study, batches, folder, crew, watch)
            folder.merge()
            if not conducted.whole or study.experiment.keep == "none":
                return conducted
            # Records are written here, whoever rode the batches.
            with LocalCrew(self._n) as crew:
                kept = ride_kept(study, folder, crew, watch)
            return Conducted(kept.whole, kept.given_up)

    def _crew(self) -> "Crew":
        from bikesim.experiment.study.crew import LocalCrew
        from bikesim.experiment.study.dask_crew import DaskCrew

        if self.scheduler is not None:
            return DaskCrew(scheduler=self.scheduler)
        return LocalCrew(self._n) if self.workers is None else DaskCrew(workers=self.workers)

    def _announce(
        self, study: "Study", folder: "ResultsFolder", batches: "list[Batch]", workers: int
    ) -> None:
        from bikesim.cli.experiment_telling import announcement

        if not self.json:
            told = announcement(study, len(folder.done), batches, workers)
            print(told, file=sys.stderr, flush=True)

    def _film(self, study: "Study", folder: "ResultsFolder") -> None:
        from bikesim.cli.render import render_run
        from bikesim.experiment.study.keep import runs_to_film, runs_to_keep
        from bikesim.experiment.study.results import read_results
        from bikesim.record.reader import open_run

        table = read_results(folder.path).table
        wanted = runs_to_film(study, table, runs_to_keep(study, table))
        missing = [run for run in wanted if not folder.video(run).exists()]
        for run in missing:
            if not render_run(open_run(folder.record(run)), folder.video(run), force=True):
                break  # why has been said
        folder.merge()

    def _report(self, folder: "ResultsFolder") -> Path | None:
        if self.no_report:
            return None
        from bikesim.report.experiment.page import write_report

        return write_report(folder.path)

    def _tell(self, folder: "ResultsFolder", report: Path | None) -> None:
        from bikesim.cli.experiment_telling import results_json, results_told
        from bikesim.experiment.study.results import read_results

        if not folder.done:
            return
        results = read_results(folder.path)
        if self.json:
            print_json(results_json(results, folder.path, report))
        else:
            print(results_told(results, folder.path, report), flush=True)

    def _status(self, folder: "ResultsFolder", conducted: "Conducted") -> int:
        from bikesim.experiment.study.conduct import told

        if conducted.given_up:
            raise InputError(told(conducted.given_up[0]) + folder.kept())
        if not conducted.whole:
            print(f"bikesim: interrupted{folder.kept()}", file=sys.stderr)
            return 130
        return 0
