"""Where each condition goes in a figure: along the axis, by colour, in a panel of its own."""

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

from bikesim.report.experiment.data import Condition, Factor

MOST_COLOURS = 6


class Mark(NamedTuple):
    """A condition in a figure: its panel, its colour and its place along the axis, by number."""

    condition: Condition
    panel: int
    colour: int
    place: int


class Layout(NamedTuple):
    """Panels with their titles, colours with what they stand for, the axis and its levels.

    `places` are numbers where the axis' factor is one, else text.
    """

    marks: tuple[Mark, ...]
    panels: tuple[str, ...]
    colours: tuple[str, ...]
    axis: Factor | None
    places: tuple[Any, ...]
    numeric: bool


def arrange(factors: Sequence[Factor], conditions: Sequence[Condition]) -> Layout:
    """The factor with most levels along the axis, numbers first; the next by colour; panels.

    Of a grid with extra conditions, or with no more than one factor, all lie along one axis.
    """
    varied = [i for i, factor in enumerate(factors) if len(factor.levels) > 1]
    whole = len({c.levels for c in conditions}) == len(conditions)
    known = all(c.levels[i] in factors[i].levels for c in conditions for i in varied)
    if not varied or not whole or not known:
        return _by_name(conditions)
    along = max(varied, key=lambda i: (factors[i].numeric, len(factors[i].levels), -i))
    rest = [i for i in varied if i != along]
    few = [i for i in rest if len(factors[i].levels) <= MOST_COLOURS]
    by_colour = min(few, key=lambda i: (len(factors[i].levels), i), default=None)
    by_panel = [i for i in rest if i != by_colour]
    cells = list(product(*(factors[i].levels for i in by_panel)))
    colours = () if by_colour is None else factors[by_colour].levels
    marks = tuple(
        Mark(
            condition,
            cells.index(tuple(condition.levels[i] for i in by_panel)),
            0 if by_colour is None else colours.index(condition.levels[by_colour]),
            factors[along].levels.index(condition.levels[along]),
        )
        for condition in conditions
    )
    return Layout(
        marks,
        tuple(_told(factors, by_panel, cell) for cell in cells),
        tuple(_told(factors, [by_colour], [level]) for level in colours if by_colour is not None),
        factors[along],
        factors[along].levels,
        factors[along].numeric,
    )


def _by_name(conditions: Sequence[Condition]) -> Layout:
    marks = tuple(Mark(condition, 0, 0, i) for i, condition in enumerate(conditions))
    names = tuple(condition.name for condition in conditions)
    return Layout(marks, ("",), (), None, names, numeric=False)


def _told(factors: Sequence[Factor], at: Sequence[int | None], levels: Sequence[Any]) -> str:
    return ", ".join(
        factors[i].at(level) for i, level in zip(at, levels, strict=True) if i is not None
    )
