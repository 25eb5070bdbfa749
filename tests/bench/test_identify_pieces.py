"""The pieces' beginnings against numpy's least squares, and all that is near tried."""

import numpy as np
import pytest

from bikesim.bench.identify_model import BarRecord, Guess, Segments
from bikesim.bench.identify_pieces import Pieces, Sought, settled

# In the order of `Guess`.
TRUTH = np.array([0.15, 0.06, 0.08, 0.003, 0.0, 0.0, 0.0, 1.0])
SOUGHT = Sought(np.arange(7), np.array([1e-4, 2e-3]))


def test_without_the_starts_is_what_a_fit_of_the_starts_leaves():
    random = np.random.default_rng(5)
    errors, by_figures, by_starts = (
        random.standard_normal(shape) for shape in ((3, 40), (3, 40, 4), (3, 40, 2))
    )
    left, slopes = Pieces(np.zeros((3, 2)), errors, by_figures, by_starts).without_starts()
    for i in range(3):
        both = np.column_stack([errors[i], by_figures[i]])
        fitted = by_starts[i] @ np.linalg.lstsq(by_starts[i], both, rcond=None)[0]
        assert left[i] == pytest.approx((both - fitted)[:, 0])
        assert slopes[i] == pytest.approx((both - fitted)[:, 1:])


def turning_bar() -> Segments:
    """`TRUTH` under a torque that turns it around near each piece's beginning, with noise."""
    random = np.random.default_rng(2)
    time = np.arange(0.0, 12.0, 1e-3)
    torque = 0.3 * np.cos(2 * np.pi * 1.01 * time)
    still = Segments(BarRecord(time, torque, 0.0 * time, 0.0 * time))
    begun = np.zeros((2, 1, still.s))
    for _ in range(still.s):  # each piece goes on where the one before it ended
        ended = np.stack(still.follow(Guess(*TRUTH[:, None, None]), *begun))[:, :, :, -1]
        begun[:, :, 1:] = ended[:, :, :-1]
    angle, rate = still.follow(Guess(*TRUTH[:, None, None]), *begun)
    steer = angle.ravel() + 1e-4 * random.standard_normal(angle.size)
    steer_rate = rate.ravel() + 2e-3 * random.standard_normal(rate.size)
    return Segments(BarRecord(time, torque, steer, steer_rate))


def costs(bar: Segments, steer: np.ndarray, steer_rate: np.ndarray) -> np.ndarray:
    """Of each piece, (g, s), for g times s starts."""
    rows = Guess(*np.tile(TRUTH[:, None, None], (1, len(steer), 1)))
    angle, rate = bar.follow(rows, steer, steer_rate)
    off = (angle - bar.steer) / SOUGHT.sizes[0], (rate - bar.steer_rate) / SOUGHT.sizes[1]
    return np.sum(np.concatenate(off, 2) ** 2, 2)


def test_the_starts_are_the_best_ones_even_of_pieces_that_begin_as_the_bar_turns_around():
    bar = turning_bar()
    starts = np.stack([bar.steer[:, 0], bar.steer_rate[:, 0]], 1)
    found = settled(bar, SOUGHT, TRUTH, starts)
    angles, rates = np.meshgrid(np.linspace(-4e-4, 4e-4, 9), np.linspace(-8e-3, 8e-3, 33))
    grid = [
        start + change.reshape(-1, 1)
        for start, change in zip(starts.T, (angles, rates), strict=True)
    ]
    assert (found.costs <= costs(bar, *grid).min(0) + 0.5).all()
