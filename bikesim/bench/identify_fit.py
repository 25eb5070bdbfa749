"""The fit of a bar's figures: least output error, by scipy's trust-region least squares.

Each piece of a record begins at an angle and rate of its own. They are eliminated by variable
projection (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 1973), with the derivative of
L. Kaufman, BIT 15, 1975. MuJoCo's system-identification toolbox is not used: its Jacobian is dense,
with all the beginnings as unknowns, its intervals take the errors of all samples for independent,
and it needs packages that bikesim does not.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.bench.identify_model import Guess, Reals, Segments
from bikesim.bench.identify_pieces import Pieces, Sought, followed, settled
from bikesim.errors import InputError

ALL = len(Guess._fields)

MOST_DELAY = 0.1
"""That is looked for [s]."""

LEAST = np.array([1e-4, 0.0, 0.0, 0.0, -10.0, -10.0, 0.0, 0.05])
MOST = np.array([100.0, 10.0, 100.0, MOST_DELAY, 10.0, 10.0, 0.1, 20.0])
"""Between which each figure of a `Guess` is sought."""

MOST_EVALUATIONS = 100
"""Of the model in a round; a fit that needs more does not converge."""

_COST_TOLERANCE, _STEP_TOLERANCE = 1e-6, 1e-5  # relative
# Rounds are made until the figures move by less than this, squared, in standard errors.
_ROUNDS, _MOVED = 20, 0.01
_FIRST_SIZES, _LEAST_SIZE = (1e-3, 1e-2), 1e-9  # rad, rad/s


class Fit(NamedTuple):
    """What came out. The p figures of a `Guess` that are `free` (p,) were sought.

    `guess` (8,), SI. `sizes` (2,): of the errors of angle [rad] and rate [rad/s] that are left,
    rms. `covariances`, each (p, p): robust against errors alike within a piece, and plain.
    `pieces`: of all records.
    """

    guess: Reals
    free: NDArray[np.intp]
    sizes: Reals
    covariances: tuple[Reals, Reals]
    pieces: int


def fit(segments: list[Segments], first: Reals, *, with_ratio: bool) -> Fit:
    """From a first guess (8,). In rounds: figures by least squares, with the motion linear in the
    pieces' beginnings; then the beginnings; then the sizes of both errors, which are their weights.

    Raises InputError for a fit that does not converge.
    """
    from scipy.optimize import least_squares

    free = np.arange(ALL if with_ratio else ALL - 1)
    guess = np.clip(first, LEAST, MOST)
    starts = [np.stack([one.steer[:, 0], one.steer_rate[:, 0]], 1) for one in segments]
    sought = Sought(free, np.array(_FIRST_SIZES))
    for count in range(_ROUNDS):
        problem = _Linear(segments, starts, sought, guess)
        found = least_squares(
            problem.errors, guess[free], problem.slopes, (LEAST[free], MOST[free]), x_scale="jac",
            ftol=_COST_TOLERANCE, xtol=_STEP_TOLERANCE, max_nfev=MOST_EVALUATIONS,
        )  # fmt: skip
        if found.status <= 0:
            break
        moved = np.sum((problem.slopes(found.x) @ (found.x - guess[free])) ** 2)
        guess[free] = found.x
        pieces = [settled(a, sought, guess, b) for a, b in zip(segments, starts, strict=True)]
        starts, sizes = [one.starts for one in pieces], sought.sizes * _sizes(pieces)
        if count and moved < _MOVED:
            return Fit(guess, free, sizes, _covariances(pieces), sum(one.s for one in segments))
        sought = Sought(free, np.maximum(sizes, _LEAST_SIZE))
    raise InputError(
        "the fit to the bar's motion does not converge: a longer or stronger excitation, and hands "
        "off the bar"
    )


class _Linear:
    """Least squares in the figures alone, with the motion linear in the starts about those given,
    which the best starts of each set of figures stay close to.
    """

    def __init__(
        self, segments: list[Segments], starts: list[Reals], sought: Sought, guess: Reals
    ) -> None:
        self._records = list(zip(segments, starts, strict=True))
        self._sought, self._guess = sought, guess.copy()
        self._at = np.full(len(sought.free), np.nan)
        self._errors = self._slopes = np.empty(0)

    def errors(self, figures: Reals) -> Reals:
        """(n,)"""
        self._go_to(figures)
        return self._errors

    def slopes(self, figures: Reals) -> Reals:
        """Their derivatives by the figures, (n, p)."""
        self._go_to(figures)
        return self._slopes

    def _go_to(self, figures: Reals) -> None:
        """Errors and slopes are asked for in turn, and cost no more together than alone."""
        if np.array_equal(figures, self._at):
            return
        self._at = figures.copy()
        self._guess[self._sought.free] = figures
        near = [
            followed(a, self._sought, self._guess, b).without_starts() for a, b in self._records
        ]
        self._errors = np.concatenate([errors.ravel() for errors, _ in near])
        self._slopes = np.concatenate([one.reshape(-1, len(figures)) for _, one in near])


def _sizes(pieces: list[Pieces]) -> Reals:
    """Rms of the errors of angle and rate, (2,)."""
    both = [one.errors.reshape(len(one.errors), 2, -1).swapaxes(0, 1) for one in pieces]
    return np.sqrt(np.mean(np.concatenate([one.reshape(2, -1) for one in both], 1) ** 2, 1))


def _covariances(pieces: list[Pieces]) -> tuple[Reals, Reals]:
    """As in `Fit`."""
    near = [one.without_starts() for one in pieces]
    hessian = sum(np.einsum("smp,smq->pq", slopes, slopes) for _, slopes in near)
    scores = np.concatenate([np.einsum("smp,sm->sp", slopes, errors) for errors, slopes in near])
    inverse = np.asarray(np.linalg.pinv(hessian, rcond=1e-12, hermitian=True), float)
    s, p = scores.shape
    return inverse @ (scores.T @ scores) @ inverse * s / max(s - p, 1), inverse
