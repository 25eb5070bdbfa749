"""A record near a set of figures: what each piece leaves unexplained, and its own beginning.

The beginnings, an angle and a rate a piece, are no figures of the bar: they are fitted to each set
of figures, or eliminated from a linear problem by projection.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.bench.identify_model import Guess, Reals, Segments

# Of the derivatives. So wide that they are an average over where friction turns within a sample,
# as the motion has kinks there; forward, as friction and delay are not below zero.
_STEPS = np.array([0.0, 1e-3, 1e-3, 2e-4, 1e-3, 1e-3, 1e-3, 1e-3])  # but the inertia's:
_INERTIA_STEP = 0.01  # relative
_START_STEP = 3e-3  # rad, rad/s

# Of the search for the starts: it ends where no piece's cost would fall by that part of it, or
# only by steps that were cut to less than that share.
_TRIALS, _LEAST_GAIN, _LEAST_SHARE = 6, 1e-4, 0.05


class Pieces(NamedTuple):
    """s pieces of m samples, p figures.

    `starts` (s, 2): angle [rad] and rate [rad/s] at their beginnings. `errors` (s, 2m): model less
    measured, of angle, then rate, in units of the sizes given. Their derivatives `by_figures`
    (s, 2m, p) and `by_starts` (s, 2m, 2).
    """

    starts: Reals
    errors: Reals
    by_figures: Reals
    by_starts: Reals

    @property
    def costs(self) -> Reals:
        """Sum of squares of each piece, (s,)."""
        return np.sum(self.errors**2, 1)

    def step(self) -> Reals:
        """Of the starts, Gauss and Newton's, (s, 2)."""
        return -np.einsum("snm,sm->sn", np.linalg.pinv(self.by_starts), self.errors)

    def without_starts(self) -> tuple[Reals, Reals]:
        """Errors and their derivatives by the figures, with the best starts if linear in these."""
        q = np.linalg.qr(self.by_starts).Q
        both = np.concatenate([self.errors[:, :, None], self.by_figures], 2)
        both = both - q @ (q.swapaxes(1, 2) @ both)
        return both[:, :, 0], both[:, :, 1:]


class Sought(NamedTuple):
    """Which figures of a `Guess` are `free` (p,), and the `sizes` (2,) of the errors of angle [rad]
    and rate [rad/s].
    """

    free: NDArray[np.intp]
    sizes: Reals


def followed(segments: Segments, sought: Sought, guess: Reals, starts: Reals) -> Pieces:
    """Near a guess (8,)."""
    p = len(sought.free)
    steps = _STEPS[sought.free]
    steps[sought.free == 0] = _INERTIA_STEP * guess[0]
    guesses = np.tile(guess, (p + 3, 1))
    guesses[1 + np.arange(p), sought.free] += steps
    begun = np.tile(starts, (p + 3, 1, 1))
    begun[[-2, -1], :, [0, 1]] += _START_STEP
    angles, rates = segments.follow(
        Guess(*(column[:, None] for column in guesses.T)), begun[:, :, 0], begun[:, :, 1]
    )
    by_angle, by_rate = 1.0 / sought.sizes
    errors = np.concatenate(
        [by_angle * (angles - segments.steer), by_rate * (rates - segments.steer_rate)], 2
    )
    steps = np.append(steps, [_START_STEP, _START_STEP])
    slopes = np.moveaxis((errors[1:] - errors[0]) / steps[:, None, None], 0, 2)
    return Pieces(starts, errors[0], slopes[:, :, :p], slopes[:, :, p:])


def settled(segments: Segments, sought: Sought, guess: Reals, starts: Reals) -> Pieces:
    """With the starts that leave least, sought from those given. A piece whose step does not help,
    as where it begins at rest, takes a shorter one.
    """
    found, share = followed(segments, sought, guess, starts), np.ones(len(starts))
    for _ in range(_TRIALS):
        step = found.step()
        gain = np.sum(np.einsum("smn,sn->sm", found.by_starts, step) ** 2, 1)
        if not np.any((gain > _LEAST_GAIN * found.costs) & (share > _LEAST_SHARE)):
            break
        trial = followed(segments, sought, guess, found.starts + share[:, None] * step)
        helps = trial.costs < found.costs
        share = np.where(helps, 1.0, 0.25 * share)
        found = Pieces(*(_chosen(helps, *pair) for pair in zip(trial, found, strict=True)))
    return found


def _chosen(these: NDArray[np.bool_], new: Reals, old: Reals) -> Reals:
    return np.where(these.reshape(-1, *[1] * (new.ndim - 1)), new, old)
