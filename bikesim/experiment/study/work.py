"""What a worker is asked for, and what it answers; where it works is another matter."""

import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.metrics import Metrics
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.basis import Basis
from bikesim.experiment.study.named_files import union
from bikesim.experiment.study.plan import Batch, RunId, Study
from bikesim.experiment.study.trial import Trial, apart
from bikesim.experiment.study.versions import Versions

# Tells how far a piece of work is, from 0 to 1, and whether it is to end.
Report = Callable[[float], bool]


class Ride(NamedTuple):
    """A batch to ride: each condition's scenario, by its number; and what it was planned with."""

    batch: Batch
    scenarios: dict[int, Scenario]
    basis: Basis

    @property
    def runs(self) -> int:
        """How many it asks for."""
        return len(self.batch.runs)


class Keep(NamedTuple):
    """A run to ride again, alone, for its record."""

    run: RunId
    scenario: Scenario
    path: Path

    @property
    def runs(self) -> int:
        """How many it asks for."""
        return 1


class Result(NamedTuple):
    """A run that came to its end."""

    run: RunId
    ending: str
    ticks: int


class Done(NamedTuple):
    """What came of a ride or of a run to keep; without those that were interrupted.

    `metrics` are those of each result; a trial has neither. `started` is a time in UTC, `seconds`
    [s] how long it took, `versions` those of the process that did it.
    """

    results: tuple[Result, ...]
    metrics: tuple[Metrics, ...]
    started: str
    seconds: float
    versions: Versions


class Progress(float):
    """How far a worker is with what it was given, from 0 to 1."""


class Refused(NamedTuple):
    """Why it cannot be done, in one line."""

    why: str


Order = Ride | Keep | Trial
Answer = Done | Refused


def order_of(study: Study, batch: Batch) -> Ride:
    """A batch with all that its worker needs."""
    numbers = sorted({run.condition for run in batch.runs})
    basis = Basis(Versions.gather(), union(study.files[number - 1] for number in numbers))
    return Ride(batch, {number: study.condition(number).scenario for number in numbers}, basis)


def scenario_of(scenario: Scenario, seed: int) -> Scenario:
    """A condition's scenario with a seed; that it is one has been checked."""
    return scenario.model_copy(update={"seed": seed})


def work(order: Order, report: Report) -> Answer:
    """Do what is asked for. Whatever goes wrong is said in one line, never raised."""
    try:
        match order:
            case Ride():
                return _ride(order, report)
            case Keep():
                return _keep(order, report)
            case Trial():
                return _try(order, report)
    except InputError as error:
        return Refused(str(error))
    except MemoryError:
        return Refused(
            f"not enough memory for {order.runs} runs at once; take a smaller batch_size"
        )
    except Exception as error:
        return Refused(f"{type(error).__name__}: {error} ({_place(error)})")


def _ride(order: Ride, report: Report) -> Answer:
    from bikesim.experiment.batch import ride_batch
    from bikesim.experiment.metrics import measure

    if differs := order.basis.difference(Basis.of(order.scenarios.values())):
        return Refused(differs)
    started, began = _now(), time.perf_counter()
    ids = order.batch.runs
    scenarios = [scenario_of(order.scenarios[run.condition], run.seed) for run in ids]
    outcomes = ride_batch(scenarios, Pulse(scenarios[0].ticks, report))
    if any(outcome.ending.reason == "interrupted" for outcome in outcomes):
        # Those that ended before the others are the falls: a rate of them would be a false one.
        return _done((), (), started, time.perf_counter() - began)
    ended = [
        (Result(run, outcome.ending.reason, outcome.history.ticks), measure(outcome.history, one))
        for run, outcome, one in zip(ids, outcomes, scenarios, strict=True)
    ]
    results, metrics = zip(*ended, strict=True)
    return _done(results, metrics, started, time.perf_counter() - began)


def _keep(order: Keep, report: Report) -> Done:
    from bikesim.experiment.history import History
    from bikesim.experiment.metrics import measure
    from bikesim.experiment.run import build, run
    from bikesim.record.reader import open_run

    started, began = _now(), time.perf_counter()
    pulse = Pulse(order.scenario.ticks, report)
    ending = run(build(order.scenario), order.path, force=True, interrupted=pulse)
    if ending.reason == "interrupted":
        order.path.unlink(missing_ok=True)
        return _done((), (), started, 0.0)
    record = open_run(order.path)
    metrics = measure(History.of_run(record), order.scenario)
    result = Result(order.run, ending.reason, record.ticks)
    return _done((result,), (metrics,), started, time.perf_counter() - began)


def _try(order: Trial, report: Report) -> Answer:
    started, began = _now(), time.perf_counter()
    pulse = Pulse(order.scenarios[0].ticks * (1 + len(order.scenarios)), report)
    if told := apart(order, pulse):
        return Refused(told)
    return _done((), (), started, time.perf_counter() - began)


def _done(
    results: tuple[Result, ...], metrics: tuple[Metrics, ...], started: str, seconds: float
) -> Done:
    return Done(results, metrics, started, seconds, Versions.gather())


class Pulse:
    """Asked at every tick whether to stop; reports a few times a second."""

    def __init__(self, ticks: int, report: Report) -> None:
        self.ticks, self._all, self._report = 0, ticks, report
        self._last = 0.0

    def __call__(self) -> bool:
        self.ticks += 1
        now = time.perf_counter()
        if now - self._last < 0.25:
            return False
        self._last = now
        return self._report(self.ticks / self._all)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _place(error: Exception) -> str:
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return "nowhere"
    return f"{Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno}"
