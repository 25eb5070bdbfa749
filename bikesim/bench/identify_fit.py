"""The fit of a bar's figures: least output error, the pieces' beginnings eliminated."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bikesim.bench.identify_model import Guess, Reals, Segments

ALL = len(Guess._fields)

MOST_DELAY = 0.1
"""That is looked for [s]."""

LEAST = np.array([1e-4, 0.0, 0.0, 0.0, -10.0, -10.0, 0.0, 0.05])
MOST = np.array([100.0, 10.0, 100.0, MOST_DELAY, 10.0, 10.0, 0.1, 20.0])
"""Between which each figure of a `Guess` is sought."""

_STEPS = np.array([1e-4, 1e-4, 1e-4, 1e-5, 1e-4, 1e-4, 1e-4, 1e-4])  # of the derivatives
_STATE_STEP = 1e-4  # rad, rad/s

# Angle and rate at the beginning of each piece of a record.
Start = tuple[Reals, Reals]


class _Linear(NamedTuple):
    """The problem near a guess, without the states: gradient (p,), Hessian (p, p), the pieces'
    scores' outer products (p, p); `pieces`: what the states need to follow a step.
    """

    gradient: Reals
    hessian: Reals
    scatter: Reals
    pieces: list[tuple[Reals, Reals, Reals]]


class Fit:
    """Gauss-Newton with Levenberg's damping.

    `guess` is the answer, `sizes` the errors of angle [rad] and rate [rad/s] that are left, rms.
    """

    def __init__(self, segments: list[Segments], *, with_ratio: bool) -> None:
        self._segments = segments
        self.free = np.arange(ALL if with_ratio else ALL - 1)
        self.guess = np.zeros(ALL)
        self._starts: list[Start] = [
            (one.steer[:, 0].copy(), one.steer_rate[:, 0].copy()) for one in segments
        ]
        self.sizes = np.array([1e-3, 1e-2])

    def solve(self, guess: Reals) -> None:
        """From a first guess; the sizes of both errors are found by the way."""
        self.guess = np.clip(guess, LEAST, MOST)
        for _ in range(3):
            self._descend()
            left = [self._misfit(one, start) for one, start in self._all()]
            angle, rate = (np.concatenate([error[i] for error in left]) for i in (0, 1))
            self.sizes = np.maximum([np.sqrt(np.mean(e**2)) for e in (angle, rate)], 1e-9)

    def covariances(self) -> tuple[Reals, Reals]:
        """Of the free figures, (p, p): robust against errors alike within a piece, and plain."""
        found = self._linear()
        inverse = np.asarray(np.linalg.pinv(found.hessian, rcond=1e-12, hermitian=True), float)
        p, pieces = len(self.free), self.pieces
        return inverse @ found.scatter @ inverse * pieces / max(pieces - p, 1), inverse

    @property
    def pieces(self) -> int:
        """Of all records."""
        return sum(one.s for one in self._segments)

    def _all(self) -> Iterator[tuple[Segments, Start]]:
        return zip(self._segments, self._starts, strict=True)

    def _descend(self) -> None:
        damping, cost = 1e-3, self._cost(self.guess, self._starts)
        for _ in range(40):
            problem = self._linear()
            while True:
                guess, starts = self._moved(problem, damping)
                new = self._cost(guess, starts)
                if new < cost:
                    break
                damping *= 10
                if damping > 1e8:
                    return
            done = cost - new < 1e-7 * cost
            self.guess, self._starts, cost, damping = guess, starts, new, damping / 10
            if done:
                return

    def _moved(self, problem: _Linear, damping: float) -> tuple[Reals, list[Start]]:
        """A step, and how the states follow it."""
        hessian = problem.hessian
        lifted = hessian + damping * np.diag(np.diag(hessian)) + 1e-9 * np.eye(len(hessian))
        step = np.zeros(ALL)
        step[self.free] = np.linalg.solve(lifted, problem.gradient)
        guess = np.clip(self.guess + step, LEAST, MOST)
        taken = (guess - self.guess)[self.free]
        starts: list[Start] = []
        for (pseudo, error, slope), (steer, rate) in zip(problem.pieces, self._starts, strict=True):
            change = np.einsum("snm,sm->sn", pseudo, error - slope @ taken)
            starts.append((steer + change[:, 0], rate + change[:, 1]))
        return guess, starts

    def _cost(self, guess: Reals, starts: list[Start]) -> float:
        total = 0.0
        for segment, (steer, rate) in zip(self._segments, starts, strict=True):
            angles, rates = segment.follow(_guesses(guess[None]), steer[None], rate[None])
            for error, size in (
                (segment.steer - angles[0], self.sizes[0]),
                (segment.steer_rate - rates[0], self.sizes[1]),
            ):
                total += float(np.sum((error / size) ** 2))
        return total if np.isfinite(total) else np.inf

    def _misfit(self, segment: Segments, start: Start) -> tuple[Reals, Reals]:
        angles, rates = segment.follow(_guesses(self.guess[None]), start[0][None], start[1][None])
        return segment.steer - angles[0], segment.steer_rate - rates[0]

    def _derivatives(self, segment: Segments, start: Start) -> tuple[Reals, Reals, Reals]:
        """Errors (s, 2m), their slopes (s, 2m, p) and those by the state (s, 2m, 2), weighted."""
        p = len(self.free)
        guesses = np.tile(self.guess, (p + 3, 1))
        guesses[1 + np.arange(p), self.free] += _STEPS[self.free]
        steer, rate = (np.tile(one, (p + 3, 1)) for one in start)
        steer[-2] += _STATE_STEP
        rate[-1] += _STATE_STEP
        angles, rates = segment.follow(_guesses(guesses), steer, rate)
        both = np.concatenate([angles / self.sizes[0], rates / self.sizes[1]], 2)
        seen = np.concatenate(
            [segment.steer / self.sizes[0], segment.steer_rate / self.sizes[1]], 1
        )
        steps = np.append(_STEPS[self.free], [_STATE_STEP, _STATE_STEP])
        slope = np.moveaxis((both[1:] - both[0]) / steps[:, None, None], 0, 2)
        return seen - both[0], slope[:, :, :p], slope[:, :, p:]

    def _linear(self) -> _Linear:
        p = len(self.free)
        gradient, hessian, scatter = np.zeros(p), np.zeros((p, p)), np.zeros((p, p))
        pieces: list[tuple[Reals, Reals, Reals]] = []
        for segment, start in self._all():
            error, slope, by_state = self._derivatives(segment, start)
            pseudo = np.asarray(np.linalg.pinv(by_state), float)
            pieces.append((pseudo, error, slope))
            clean = slope - by_state @ (pseudo @ slope)
            scores = np.einsum("smp,sm->sp", clean, error)
            gradient += scores.sum(0)
            hessian += np.einsum("smp,smq->pq", clean, clean)
            scatter += scores.T @ scores
        return _Linear(gradient, hessian, scatter, pieces)


def _guesses(rows: Reals) -> Guess:
    return Guess(*(column[:, None] for column in rows.T))
