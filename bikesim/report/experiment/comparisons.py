"""Which conditions are held against each other: two levels of a factor, or two by name."""

from collections.abc import Iterator, Sequence, Set
from typing import Any, NamedTuple

from bikesim.report.experiment.data import Comparison, Condition, Factor, shown

MOST = 40
"""Comparisons that are made unasked: the more, the less each of them can show."""


class Asked(NamedTuple):
    """A factor by its name, and two of its levels: the second is read as against the first."""

    factor: str
    first: Any
    second: Any


class Named(NamedTuple):
    """Two conditions by name, of the grid or beside it: the first is read as against the second."""

    of: str
    against: str


def comparisons(
    asked: Sequence[Asked | Named], factors: Sequence[Factor], conditions: Sequence[Condition]
) -> tuple[Comparison, ...]:
    """One for each pair of conditions that differ in these levels and in nothing else, or by name.

    Levels are those of the grid alone: a condition beside it may differ in more than its levels
    say. Where nothing is asked: the first level of each factor with each other, factor by factor
    as long as there are no more than MOST, of the first factor the first MOST. What is asked twice,
    in whichever order, is made and counted once: as it was asked first.
    """
    there = {one.name for one in conditions}
    conditions = [one for one in conditions if not one.beside]
    if asked:
        once: dict[frozenset[str], Comparison] = {}
        for one in asked:
            by_name = isinstance(one, Named)
            for made in _named(one, there) if by_name else _made(one, factors, conditions):
                once.setdefault(frozenset((made.first, made.second)), made)
        return tuple(once.values())
    found: list[Comparison] = []
    for factor in factors:
        first, *others = factor.levels
        more = [
            made
            for other in others
            for made in _made(Asked(factor.name, first, other), factors, conditions)
        ]
        if found and len(found) + len(more) > MOST:
            break
        found += more
    return tuple(found[:MOST])


def _made(
    asked: Asked, factors: Sequence[Factor], conditions: Sequence[Condition]
) -> Iterator[Comparison]:
    at = next(i for i, factor in enumerate(factors) if factor.name == asked.factor)
    others = {_but(one.levels, at): one for one in conditions if one.levels[at] == asked.second}
    for condition in conditions:
        other = others.get(_but(condition.levels, at))
        if condition.levels[at] == asked.first and other is not None:
            name = _name(at, factors, condition, other)
            yield Comparison(name, condition.name, other.name)


def _named(asked: Named, there: Set[str]) -> Iterator[Comparison]:
    """None as long as one of them has no run yet."""
    if {asked.of, asked.against} <= there:
        yield Comparison(f"{asked.of} against {asked.against}", asked.against, asked.of)


def _but(levels: tuple[Any, ...], at: int) -> tuple[Any, ...]:
    """The levels of all factors but one."""
    return levels[:at] + levels[at + 1 :]


def _name(at: int, factors: Sequence[Factor], first: Condition, second: Condition) -> str:
    """Such as: law off against paper, where speed 3.5 m/s."""
    change = f"{factors[at].label} {shown(second.levels[at])} against {shown(first.levels[at])}"
    change = f"{change} {factors[at].unit}".rstrip()
    rest = [
        factor.at(level)
        for i, (factor, level) in enumerate(zip(factors, first.levels, strict=True))
        if i != at
    ]
    return f"{change}, where {', '.join(rest)}" if rest else change
