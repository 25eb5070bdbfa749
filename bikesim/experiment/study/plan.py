"""Which runs an experiment has, and which are ridden together."""

import math
import re
from collections.abc import Hashable, Iterator, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from bikesim.errors import InputError
from bikesim.experiment.history import history_bytes
from bikesim.experiment.study.contrasts import check_contrasts
from bikesim.experiment.study.factors import Factor, make_factors
from bikesim.experiment.study.grid import Condition, count_conditions, make_conditions
from bikesim.experiment.study.named_files import Files, files_of_each
from bikesim.experiment.study.settings import Experiment


class RunId(NamedTuple):
    """A run: the number of its condition, and its seed."""

    condition: int
    seed: int

    def __str__(self) -> str:
        return f"{self.condition}-{self.seed}"


class Batch(NamedTuple):
    """Runs that ride together."""

    number: int
    runs: tuple[RunId, ...]


@dataclass(frozen=True, eq=False)
class Study:
    """An experiment, ready to be ridden: every condition's scenario is sound."""

    experiment: Experiment
    factors: tuple[Factor, ...]
    conditions: tuple[Condition, ...]

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.conditions) * len(self.experiment.seeds)

    @cached_property
    def groups(self) -> tuple[tuple[Condition, ...], ...]:
        """Conditions whose runs can share a batch, those that cost most first."""
        from bikesim.experiment.batch import batch_key

        found: dict[Hashable, list[Condition]] = {}
        for condition in self.conditions:
            found.setdefault(batch_key(condition.scenario), []).append(condition)
        groups = sorted(found.values(), key=lambda group: -group[0].scenario.ticks)
        return tuple(tuple(group) for group in groups)

    @cached_property
    def files(self) -> tuple[Files, ...]:
        """Those that each condition is made of, as they are when first asked for."""
        return files_of_each(condition.scenario for condition in self.conditions)

    def ids(self) -> Iterator[RunId]:
        """All runs, condition by condition."""
        for condition in self.conditions:
            for seed in self.experiment.seeds:
                yield RunId(condition.number, seed)

    def condition(self, number: int) -> Condition:
        """A condition by its number."""
        return self.conditions[number - 1]

    def file_name(self, run: RunId) -> str:
        """Of what a run leaves, without a suffix: in the order of the table."""
        width = len(str(len(self.conditions)))
        slug = re.sub(r"[^\w.+=-]+", "-", self.condition(run.condition).name).strip("-")
        return f"{run.condition:0{width}d}-{slug[:80]}-seed{run.seed}"

    def batches(self, done: Set[RunId], size: int, workers: int) -> Iterator[Batch]:
        """The runs that are not done, at most `size` a batch, alike for all workers if they can.

        Of long runs fewer: a batch keeps the signals of its runs in memory.

        What a run gives does not depend on the batch that it is in; how long it takes does.
        """
        number = 0
        for group in self.groups:
            ids = [
                run
                for condition in group
                for seed in self.experiment.seeds
                if (run := RunId(condition.number, seed)) not in done
            ]
            # Many groups keep all workers busy as they are.
            share = workers if len(self.groups) < 4 * workers else 1
            for first, last in _shares(len(ids), min(size, _that_fit(group)), share):
                number += 1
                yield Batch(number, tuple(ids[first:last]))


def _that_fit(group: Sequence[Condition]) -> int:
    """How many runs of these conditions a batch has memory for; at least one."""
    longest = max(history_bytes(one.scenario.duration, one.scenario.period) for one in group)
    return max(1, _BATCH_MEMORY // longest)


_BATCH_MEMORY = 512 * 2**20  # bytes of signals: 699 runs of 60 s


def make_study(experiment: Experiment) -> Study:
    """All conditions of an experiment. Raises InputError, also for too many runs."""
    factors = make_factors(experiment)
    runs = count_conditions(experiment, factors) * len(experiment.seeds)
    if runs > experiment.max_runs:
        raise TooManyError(runs, next(make_conditions(experiment, factors)), experiment)
    conditions = tuple(make_conditions(experiment, factors))
    check_contrasts(experiment, factors, conditions)
    return Study(experiment, factors, conditions)


class TooManyError(InputError):
    """More runs than the experiment allows itself."""

    def __init__(self, runs: int, first: Condition, experiment: Experiment) -> None:
        super().__init__(f"{runs} runs: more than max_runs = {experiment.max_runs}")
        self.runs, self.scenario = runs, first.scenario


# A batch of fewer costs nearly as much as one of so many.
_SMALLEST = 64


def _shares(runs: int, size: int, workers: int) -> Iterator[tuple[int, int]]:
    """Where each batch of so many runs begins and ends."""
    if runs == 0:
        return
    batches = math.ceil(runs / size)
    if batches % workers and batches < 8 * workers:
        # As many for each worker, if they do not get too small by that.
        rounded = workers * math.ceil(batches / workers)
        batches = max(batches, min(rounded, math.ceil(runs / min(size, _SMALLEST))))
    edges = [runs * i // batches for i in range(batches + 1)]
    yield from pairwise(edges)
