"""A figure of one rider is a float; of a batch's, the same float or an array of theirs."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bikesim.errors import InputError
from bikesim.model.real import Real


def figure(name: str, each: Sequence[Any]) -> Any:
    """One value where all are equal, else an array (n,) of numbers. Raises InputError."""
    first = each[0]
    if all(one is first or one == first for one in each):
        return first
    if not all(isinstance(one, float | int) for one in each):
        raise InputError(f"{name}: riders who differ in it cannot be one batch")
    return np.array(each, dtype=float)


def each_of(count: int, value: Real) -> list[float]:
    """The figures of `count` riders, one by one, of a figure for them all."""
    return [value] * count if np.ndim(value) == 0 else value.tolist()


def elementwise(function: Callable[..., tuple[float, ...]], *figures: Real) -> tuple[Real, ...]:
    """What `function` of floats gives; for arrays (n,), to the bit what each has alone."""
    count = max(np.size(one) for one in figures)
    if all(np.ndim(one) == 0 for one in figures):
        return function(*figures)
    known: dict[Any, tuple[float, ...]] = {}
    columns = zip(*(each_of(count, one) for one in figures), strict=True)
    rows = [known.get(one) or known.setdefault(one, function(*one)) for one in columns]
    return tuple(np.array(rows).T.copy())
