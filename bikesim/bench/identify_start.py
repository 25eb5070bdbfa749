"""A first guess of a bar's figures, for the fit to begin at."""

from typing import NamedTuple

import numpy as np

from bikesim.bench.identify_model import Reals, Segments

_WINDOW = 0.03  # s
_DELAYS = np.arange(0.0, 0.0401, 0.002)  # s


class _Windows(NamedTuple):
    """What the momentum gained over short windows (w,) [rad/s] is made of, (w, 4)."""

    gained: Reals
    causes: Reals


def first_guess(segments: list[Segments]) -> Reals:
    """In the order of `Guess`; the delay of a few with which least is left unexplained.

    By linear least squares on the momentum over short windows,
    Δδ̇ = (∫u dt - F ∫sign δ̇ dt - b Δδ + c Δt) / I, of the records without added inertia.
    """
    bare = [one for one in segments if one.record.added_inertia == 0.0] or segments
    fits = [_fitted(bare, float(delay)) for delay in _DELAYS]
    _, guess = min(fits, key=lambda fit: fit[0])
    return guess


def _fitted(segments: list[Segments], delay: float) -> tuple[float, Reals]:
    windows = [_windows(one, delay) for one in segments]
    gained = np.concatenate([one.gained for one in windows])
    causes = np.concatenate([one.causes for one in windows])
    solved, *_ = np.linalg.lstsq(causes, gained, rcond=None)
    left = float(np.sum((gained - causes @ solved) ** 2))
    inverse = max(float(solved[0]), 1e-2)
    coulomb, viscous, offset = (float(x) / inverse for x in solved[1:])
    added = segments[0].record.added_inertia
    inertia = max(1.0 / inverse - added, 1e-3)
    return left, np.array(
        [inertia, max(coulomb, 0.005), max(viscous, 0.005), delay, offset, 0.0, 0.005, 1.0]
    )


def _windows(one: Segments, delay: float) -> _Windows:
    jump = max(2, round(_WINDOW / float(np.median(one.steps))))
    starts = np.arange(0, one.m - jump, jump)

    def over(rate: Reals) -> Reals:
        total = np.concatenate([np.zeros((one.s, 1)), np.cumsum(rate * one.steps, 1)], 1)
        return total[:, starts + jump] - total[:, starts]

    turned = one.steer[:, starts + jump] - one.steer[:, starts]
    causes = np.stack(
        [
            over(one.torque(delay)),
            -over(np.sign(one.steer_rate)),
            -turned,
            over(np.ones_like(one.steer)),
        ],
        axis=-1,
    )
    gained = one.steer_rate[:, starts + jump] - one.steer_rate[:, starts]
    return _Windows(gained.ravel(), causes.reshape(-1, 4))
