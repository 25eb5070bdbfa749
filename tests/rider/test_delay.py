"""Signals that come late, against a list of what came in."""

import random
from typing import Any, NamedTuple

import numpy as np
import pytest

from bikesim.rider.delay import delay_line


class Pair(NamedTuple):
    a: Any
    b: Any


@pytest.mark.parametrize("steps", [1, 7, 400])
def test_it_is_exact_in_steps(steps: int):
    line = delay_line(steps * 5e-4, 5e-4, Pair(9.0, 8.0))
    assert line is not None
    came = [line(Pair(float(k), 0.0)) for k in range(steps + 3)]
    assert came[:steps] == [Pair(9.0, 8.0)] * steps
    assert came[steps:] == [Pair(0.0, 0.0), Pair(1.0, 0.0), Pair(2.0, 0.0)]


@pytest.mark.parametrize(("delay", "steps"), [(0.0, 0), (2e-4, 0), (3e-4, 1), (9.9e-3, 20)])
def test_a_delay_is_rounded_to_steps(delay: float, steps: int):
    line = delay_line(delay, 5e-4, Pair(9.0, 8.0))
    if steps == 0:
        assert line is None
        return
    assert line is not None
    assert [line(Pair(1.0, 1.0)).a for _ in range(steps + 1)] == [9.0] * steps + [1.0]


@pytest.mark.parametrize("seed", range(30))
def test_each_of_many_has_his_own(seed: int):
    """The same signals may come in several times, as a sight does within a tick."""
    chance = random.Random(seed)
    steps = [chance.randint(0, chance.choice([1, 5, 30])) for _ in range(chance.randint(2, 6))]
    line = delay_line(np.array(steps) * 1e-3 + 1e-9, 1e-3, Pair(np.zeros(len(steps)), 9.0))
    assert line is not None
    history = []
    now = Pair(np.zeros(len(steps)), -1.0)
    for k in range(100):
        if chance.random() < 0.6:
            now = Pair(np.array([chance.random() for _ in steps]), float(k))
        history.append(now)
        late = line(now)
        for i, back in enumerate(steps):
            a, b = (history[k - back].a[i], history[k - back].b) if back <= k else (0.0, 9.0)
            assert (late.a[i], late.b[i]) == (a, b)
