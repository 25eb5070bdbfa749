"""What the rider's torque has beside his law: coloured noise, as an autoregression of blocks."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim.identify.structure import Vector

MOST = 12
"""Highest order: a quarter of a second of blocks."""

WHITE = np.ones(1)


def autoregression(residuals: Sequence[Vector], order: int | None = None) -> Vector:
    """A(q) = 1 + a_1 q⁻¹ + … with A e white; by default of the least BIC [Schwarz 1978].

    `residuals` e of each ride; one A for all of them.
    """
    rows = np.vstack([np.column_stack([before(MOST, e), e[MOST:]]) for e in residuals])
    count, triangle = len(rows), np.asarray(np.linalg.qr(rows, mode="r"))
    best, found = np.inf, WHITE
    for tried in range(MOST + 1) if order is None else [order]:
        a, *_ = np.linalg.lstsq(triangle[:tried, :tried], triangle[:tried, -1], rcond=None)
        left = max(float(np.sum(triangle[tried:, -1] ** 2)), 1e-300) / count
        score = count * np.log(left) + tried * np.log(count)
        if score < best:
            best, found = score, np.concatenate([WHITE, -a])
    return found


def before(order: int, e: Vector) -> NDArray[np.floating[Any]]:
    """The `order` values before each value of e from that on, the nearest first."""
    return np.lib.stride_tricks.sliding_window_view(e, order + 1)[:, :-1][:, ::-1]


def whitened(noise: Vector, values: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """A(q) on each column of (blocks, n) or on (blocks,), the first values left out."""
    order = len(noise) - 1
    count = len(values) - order
    return sum(
        (a * values[order - k : order - k + count] for k, a in enumerate(noise)),
        start=np.zeros_like(values[order:]),
    )
