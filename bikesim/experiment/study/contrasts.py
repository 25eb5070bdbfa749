"""Whether what an experiment's report is to compare is there."""

from collections.abc import Sequence

from bikesim.errors import InputError, unknown
from bikesim.experiment.study.factors import Factor
from bikesim.experiment.study.grid import Condition
from bikesim.experiment.study.settings import Contrast, Experiment

_WHERE = "report.contrasts"


def check_contrasts(
    experiment: Experiment, factors: Sequence[Factor], conditions: Sequence[Condition]
) -> None:
    """Refuse contrasts of factors, levels or conditions that are none. Raises InputError."""
    names = [condition.name for condition in conditions]
    for contrast in experiment.report.contrasts:
        if contrast.factor:
            _check_levels(contrast, factors)
        else:
            _check_names(contrast, names)


def _check_levels(contrast: Contrast, factors: Sequence[Factor]) -> None:
    factor = next((one for one in factors if one.name == contrast.factor), None)
    if factor is None:
        known = ", ".join(one.name for one in factors) or "none"
        raise InputError(f"{_WHERE}: no factor {contrast.factor!r}; there are: {known}")
    values = [level.value for level in factor.levels]
    for level in contrast.levels:
        if level not in values:
            known = ", ".join(str(value) for value in values)
            raise InputError(f"{_WHERE}: {contrast.factor} has no level {level!r}; it has: {known}")
    if contrast.levels[0] == contrast.levels[1]:
        raise InputError(f"{_WHERE}: {contrast.factor}: two different levels, please")


def _check_names(contrast: Contrast, names: Sequence[str]) -> None:
    for key, name in (("of", contrast.of), ("against", contrast.against)):
        if name not in names:
            raise InputError(f"{_WHERE}.{key}: {unknown('condition', name, names)}")
    if contrast.of == contrast.against:
        raise InputError(f"{_WHERE}: {contrast.of!r}: two different conditions, please")
