"""How long an experiment will take, from a second of it."""

import time
from collections.abc import Sequence
from itertools import islice

from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.plan import Batch, Study
from bikesim.experiment.study.work import scenario_of

_TRIAL = 1.0  # [s]


def ticks_a_second(scenarios: Sequence[Scenario]) -> float:
    """Ticks of runs that one core rides in a second, of scenarios that can share a batch."""
    from bikesim.experiment.batch import ride_batch

    trial = _Trial()
    ride_batch(scenarios, trial)
    return trial.ticks * len(scenarios) / max(trial.seconds, 1e-6)


def seconds_for(study: Study, batches: Sequence[Batch], workers: int) -> float:
    """How long the batches take [s] where none falls: a fall ends a run early."""
    if not batches:
        return 0.0
    ticks = sum(
        study.condition(run.condition).scenario.ticks for batch in batches for run in batch.runs
    )
    largest = max(batches, key=lambda batch: len(batch.runs))
    rate = ticks_a_second(
        [scenario_of(study.condition(run.condition).scenario, run.seed) for run in largest.runs]
    )
    return ticks / (rate * min(workers, len(batches)))


def seconds_for_many(scenario: Scenario, runs: int, size: int, workers: int) -> float:
    """How long so many runs like one take [s]."""
    seeds = islice(range(1, size + 1), runs)
    rate = ticks_a_second([scenario_of(scenario, seed) for seed in seeds])
    return runs * scenario.ticks / (rate * workers)


def told(seconds: float) -> str:
    """A time as one says it."""
    if seconds < 10:
        return "a few seconds"
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 100 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.0f} h" if seconds < 100 * 3600 else f"{seconds / 86400:.0f} days"


class _Trial:
    """Ends a batch after a while, and says how far it came."""

    def __init__(self) -> None:
        self.ticks, self.seconds, self._began = -1, 0.0, 0.0

    def __call__(self) -> bool:
        now = time.perf_counter()
        if self.ticks < 0:
            self._began = now  # the first tick has what is made only once
        self.ticks += 1
        self.seconds = now - self._began
        return self.seconds > _TRIAL
