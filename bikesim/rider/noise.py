"""Noise of a given size and bandwidth, whatever the step: of the senses, and the remnant."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.figures import elementwise

_BLOCK = 4096
_BLOCK_OF_MANY = 512  # steps: one draw for all of a batch stays in the cache

# The source of a rider's noise; of a batch's, one for each, which gives it what it has alone.
Random = np.random.Generator | Sequence[np.random.Generator]
Noise = Iterator[Real]


def coloured_noise(rms: Real, bandwidth: Real, step: float, random: Random) -> Noise:
    """White noise through a first-order lag, a value a step; of a batch, arrays (n,).

    `rms` (in the unit of what it is added to) and `bandwidth` [rad/s] hold whatever the step [s]
    (exact Ornstein-Uhlenbeck); it starts in its stationary distribution.
    """
    decay, kick = elementwise(lambda s, b: _decay_and_kick(s, b, step), rms, bandwidth)
    if isinstance(random, np.random.Generator):
        return _values(rms * float(random.standard_normal()), decay, kick, random)
    first = rms * np.array([one.standard_normal() for one in random])
    return _values_of_many(first, np.asarray(decay), _kicks_of_many(kick, random))


def _values(value: float, decay: float, kick: float, random: np.random.Generator) -> Noise:
    while True:
        for normal in random.standard_normal(_BLOCK).tolist():
            yield value
            value = decay * value + kick * normal


def _values_of_many(value: Real, decay: Real, kicks: Noise) -> Noise:
    for kick in kicks:
        yield value
        value = decay * value + kick


def _kicks_of_many(kick: Real, random: Sequence[np.random.Generator]) -> Noise:
    # Rows a few values longer than a power of two: their columns do not share a place in the cache.
    drawn = np.empty((len(random), _BLOCK_OF_MANY + 8))[:, :_BLOCK_OF_MANY]
    while True:
        for source, row in zip(random, drawn, strict=True):
            source.standard_normal(out=row)
        yield from np.multiply(kick, drawn.T, order="C")


def spawned(random: Random, count: int) -> list[Random]:
    """So many further sources; what `random` itself gives stays the same."""
    if isinstance(random, np.random.Generator):
        return list(random.spawn(count))
    return [list(sources) for sources in zip(*(one.spawn(count) for one in random), strict=True)]


def _decay_and_kick(rms: float, bandwidth: float, step: float) -> tuple[float, float]:
    decay = math.exp(-bandwidth * step)
    return decay, rms * math.sqrt(1 - decay**2)
