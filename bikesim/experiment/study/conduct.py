"""Rides what is missing of an experiment: workers are given batches, their answers are kept."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import Any, NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.study.crew import Crew, Lost
from bikesim.experiment.study.folder import ResultsFolder
from bikesim.experiment.study.keep import runs_to_keep
from bikesim.experiment.study.plan import Batch, RunId, Study
from bikesim.experiment.study.results import read_results
from bikesim.experiment.study.same_run import difference, note_of, rows_by_run
from bikesim.experiment.study.trial import Trial, trials_of
from bikesim.experiment.study.work import Done, Keep, Order, Refused, Ride, order_of, scenario_of
from bikesim.record.output import unwritable


class Conducted(NamedTuple):
    """How it went: whether all is done; and orders that cannot be, each with the reason."""

    whole: bool
    given_up: tuple[Lost, ...]


def try_riders(study: Study, crew: Crew, interrupted: Callable[[], bool]) -> Conducted:
    """Rides each rider of the user's own for a second, alone and in a batch.

    Raises InputError for one whose rides differ: what a table says of him would be of another.
    """
    trials = trials_of(study)
    if not trials:
        return Conducted(True, ())
    with _bar(len(trials), 0, "rider") as bar:
        return _conduct(iter(trials), crew, _nothing_to_take, interrupted, bar, lambda: "")


def _nothing_to_take(order: Order, done: Done, worker: str) -> None: ...


def ride_batches(
    study: Study,
    batches: Iterable[Batch],
    folder: ResultsFolder,
    crew: Crew,
    interrupted: Callable[[], bool],
) -> Conducted:
    """Rides batches and puts what comes of them into the folder, as it comes.

    A batch whose worker dies is ridden once more. Raises InputError: what was computed stays.
    """
    with _bar(study.runs, len(folder.done), "run") as bar:
        fell = 0

        def take(order: Order, done: Done, worker: str) -> None:
            nonlocal fell
            assert isinstance(order, Ride)
            folder.add(order.batch.number, done, worker)
            fell += sum(bool(metrics.fell) for metrics in done.metrics)
            bar.set_postfix_str(f"{fell} fell", refresh=False)

        orders = (order_of(study, batch) for batch in batches)
        return _conduct(orders, crew, take, interrupted, bar, folder.kept)


def ride_kept(
    study: Study, folder: ResultsFolder, crew: Crew, interrupted: Callable[[], bool]
) -> Conducted:
    """Rides again, alone, the runs that are to leave a record and have none. Raises InputError."""
    table = read_results(folder.path).table
    keeps = [
        Keep(run, scenario_of(study.condition(run.condition).scenario, run.seed), path)
        for run in runs_to_keep(study, table)
        if not _is_whole(path := folder.record(run))
    ]
    if not keeps:
        return Conducted(True, ())
    try:
        keeps[0].path.parent.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(keeps[0].path, error) from error
    rows, differing = rows_by_run(table), list[tuple[RunId, str]]()

    def take(order: Order, done: Done, worker: str) -> None:
        del order, worker
        for result, metrics in zip(done.results, done.metrics, strict=True):
            if how := difference(rows[result.run], result, metrics):
                differing.append((result.run, how))

    with _bar(len(keeps), 0, "record") as bar:
        conducted = _conduct(iter(keeps), crew, take, interrupted, bar, folder.kept)
    if note := note_of(differing, len(keeps)):
        print(note, file=sys.stderr)
    return conducted


def _conduct(
    orders: Iterator[Order],
    crew: Crew,
    take: Callable[[Order, Done, str], None],
    interrupted: Callable[[], bool],
    bar: Any,
    kept: Callable[[], str],
) -> Conducted:
    again, retried = list[Order](), list[Order]()
    given_up: list[Lost] = []
    done, stopped = bar.n, False
    left = _Left(orders)
    while crew.busy or ((again or left) and not stopped):
        while crew.free and not stopped and (again or left):
            crew.give(again.pop() if again else left.pop())
        for event in crew.wait(0.25):
            if isinstance(event, Lost):
                if any(event.order is one for one in retried):
                    given_up.append(event)
                else:
                    again.append(event.order)
                    retried.append(event.order)
            elif isinstance(event.answer, Refused):
                raise InputError(_refusal(event.order, event.answer) + kept())
            else:
                take(event.order, event.answer, event.worker)
                done += len(event.answer.results)
        _show(bar, done + crew.progress)
        if not stopped and interrupted():
            stopped = True
            crew.stop()
    return Conducted(not (again or left or stopped or given_up), tuple(given_up))


class _Left:
    """What is left of an iterator, and whether there is any."""

    def __init__(self, orders: Iterator[Order]) -> None:
        self._orders = orders
        self._next = next(orders, None)

    def __bool__(self) -> bool:
        return self._next is not None

    def pop(self) -> Order:
        order = self._next
        assert order is not None
        self._next = next(self._orders, None)
        return order


def told(lost: Lost) -> str:
    """One line for what is given up."""
    ended = f"{_named(lost.order)}: its worker ended twice ({lost.how})"
    if isinstance(lost.order, Trial):
        return ended
    return f"{ended}; is there enough memory? A smaller batch_size takes less"


def _refusal(order: Order, answer: Refused) -> str:
    # What a trial finds says whose it is.
    return answer.why if isinstance(order, Trial) else f"{_named(order)}: {answer.why}"


def _named(order: Order) -> str:
    match order:
        case Ride():
            runs = f"{order.runs} runs, the first {order.batch.runs[0]}"
            return f"batch {order.batch.number} ({runs})"
        case Keep():
            return f"run {order.run}, ridden for its record"
        case Trial():
            return f"rider {order.rider}, tried for a second"


def _is_whole(path: Any) -> bool:
    from bikesim.record.reader import open_run

    with suppress(InputError):
        return open_run(path).complete
    return False


def _bar(total: int, initial: int, unit: str) -> Any:
    from tqdm import tqdm

    return tqdm(
        total=total,
        initial=initial,
        unit=unit,
        leave=False,
        file=sys.stderr,
        disable=not sys.stderr.isatty(),
        smoothing=0.05,  # workers tell of themselves in turn
        bar_format="{desc}{percentage:3.0f}%|{bar}| {n:.0f}/{total_fmt} "
        "[{elapsed}<{remaining}, {rate_fmt}{postfix}]",
    )


def _show(bar: Any, done: float) -> None:
    with suppress(OSError):  # the terminal may be gone
        bar.update(max(0.0, done - bar.n))
        bar.refresh()
