"""Whether every condition can be ridden, before any is."""

from bikesim.errors import InputError
from bikesim.experiment.study.grid import Condition
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.work import scenario_of


def check_conditions(study: Study) -> None:
    """Makes bicycle, rider, rig and path of each condition. Raises InputError."""
    seed = study.experiment.seeds[0]
    for condition in study.conditions:
        _check(condition, seed)


def _check(condition: Condition, seed: int) -> None:
    from bikesim.experiment.run import build

    try:
        build(scenario_of(condition.scenario, seed)).rig.close()
    except InputError as error:
        raise InputError(f"condition {condition.name!r}: {error}") from None
