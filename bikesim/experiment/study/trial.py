"""Whether a rider of the user's own rides in a batch as he does alone, before thousands of runs."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bikesim.errors import InputError
from bikesim.experiment.history import History
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.plan import Study

_TIME = 1.0  # [s] of riding
# Upright and undisturbed a rider may have nothing to do; roll at the start [deg].
_LEANS = (2.0, -3.0, 1.0)
# Rounding (of NumPy's sine, say), after a second of an unstable bicycle; N m, rad.
_ROUNDING = 1e-9


class Trial(NamedTuple):
    """Short rides to be ridden together and one by one: all of one rider, of one `batch_key`."""

    scenarios: tuple[Scenario, ...]

    @property
    def runs(self) -> int:
        """Of the experiment it has none."""
        return 0

    @property
    def rider(self) -> str:
        """His name."""
        return self.scenarios[0].rider.name


def trials_of(study: Study) -> list[Trial]:
    """One for each rider of the user's own, with figures and speeds from all over the grid."""
    trials: dict[str, Trial] = {}
    for group in study.groups:
        if (rider := group[0].scenario.rider).custom and rider.name not in trials:
            last = len(group) - 1
            some = [group[i * last // (len(_LEANS) - 1)].scenario for i in range(len(_LEANS))]
            trials[rider.name] = Trial(tuple(_short(one, i) for i, one in enumerate(some)))
    return list(trials.values())


def apart(trial: Trial, interrupted: Callable[[], bool]) -> str:
    """How his rides in a batch differ from those alone; empty where they are the same.

    What he does wrong in a batch is no difference: the ride itself tells it, with the run that it
    is in. Raises InputError for what he does wrong alone, which no batch would tell.
    """
    from bikesim.experiment.batch import ride_batch

    try:
        outcomes = ride_batch(trial.scenarios, interrupted)
    except InputError:
        return ""
    for scenario, outcome in zip(trial.scenarios, outcomes, strict=True):
        if told := _apart(_alone(scenario, interrupted), outcome.history):
            return (
                f"rider {trial.rider} does not ride in a batch as he does alone: {told}; "
                f"bikesim rider check says more, batch = False in his class rides each by himself"
            )
    return ""


def _short(scenario: Scenario, i: int) -> Scenario:
    start = scenario.start.model_copy(update={"roll_deg": _LEANS[i], "roll_rate_deg_s": 0.0})
    duration = min(_TIME, scenario.duration)
    return scenario.model_copy(update={"start": start, "duration": duration, "seed": i + 1})


def _alone(scenario: Scenario, interrupted: Callable[[], bool]) -> History:
    from bikesim.experiment.batch_history import BatchHistory
    from bikesim.experiment.run import build, ride_parts

    kept = BatchHistory(1, scenario.period, scenario.ticks)
    count = _Counted(kept)
    ending = ride_parts(build(scenario), count, interrupted)
    return kept.history(0, ending, count.ticks)


class _Counted:
    def __init__(self, kept) -> None:
        self.ticks, self._append = 0, kept.append

    def append(self, row: tuple[float, ...]) -> None:
        self.ticks += 1
        self._append(row)


def _apart(alone: History, together: History) -> str:
    count = min(len(alone.time), len(together.time))
    for name, unit in (("rider_torque", "N m"), ("steer", "rad"), ("roll", "rad")):
        mine, theirs = (getattr(one, name)[:count] for one in (alone, together))
        wrong = np.flatnonzero(np.abs(mine - theirs) > _ROUNDING * np.maximum(1.0, np.abs(mine)))
        if wrong.size:
            i = int(wrong[0])
            what = name.replace("_", " ")
            return (
                f"after {alone.time[i]:g} s the {what} is {mine[i]:.6g} {unit} alone and "
                f"{theirs[i]:.6g} {unit} in a batch of {len(_LEANS)}"
            )
    return ""
