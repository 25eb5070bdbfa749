"""Inertia, friction, delay and torque ratio of a bench's bar, from what was sent and what it did.

Nothing here knows a bus: records in, figures with intervals out. The output error of angle and rate
over short pieces is least; each piece begins at a state of its own. The intervals allow for errors
that are alike within a piece (cluster-robust), as those of a model that leaves something out are.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bikesim.bench.identify_fit import ALL, LEAST, MOST, Fit, fit
from bikesim.bench.identify_model import BarRecord, Guess, Reals, Segments
from bikesim.bench.identify_start import first_guess
from bikesim.errors import InputError

LEAST_MOTION = 0.01
"""A bar that moves less than this [rad] tells nothing."""

# Nothing is known better than the model's steps resolve: part of a figure, and of a step.
_RELATIVE_FLOOR, _DELAY_FLOOR = 2e-3, 0.1

_UNITS = ("kg m²", "N m", "N m s/rad", "s", "N m", "rad/s", "s", "1")
# In units of torque: known up to the ratio of real to commanded.
_BY_TORQUE = ("inertia", "coulomb_friction", "viscous_friction", "offset")


class Figure(NamedTuple):
    """A figure and its interval."""

    name: str
    unit: str
    value: float
    low: float
    high: float

    @property
    def half(self) -> float:
        """Half the interval."""
        return 0.5 * (self.high - self.low)

    def over(self, ratio: float) -> "Figure":
        """In another unit."""
        return self._replace(value=self.value / ratio, low=self.low / ratio, high=self.high / ratio)


@dataclass(frozen=True)
class BarFigures:
    """A bar as identified, with intervals of `confidence`; see `Guess` for what each figure is.

    Inertia and friction are in units of the torque that was sent. `torque_ratio` is known only
    from records with different added inertia; else None. `angle_error` [rad] and `rate_error`
    [rad/s]: what the model leaves of the measurement, root mean square.
    """

    inertia: Figure
    coulomb_friction: Figure
    viscous_friction: Figure
    delay: Figure
    offset: Figure
    torque_ratio: Figure | None
    angle_error: float
    rate_error: float
    confidence: float

    def all(self) -> tuple[Figure, ...]:
        """Those there are."""
        figures = (self.inertia, self.coulomb_friction, self.viscous_friction, self.delay)
        ratio = () if self.torque_ratio is None else (self.torque_ratio,)
        return (*figures, self.offset, *ratio)


def identify_bar(records: Sequence[BarRecord], *, confidence: float = 0.95) -> BarFigures:
    """The figures of the bar that all `records` are of. Raises InputError for records of which
    none can be had: a bar that did not move, a fit that is none, that does not converge, or that
    ends where the search ends.
    """
    segments = [Segments(record) for record in records]
    moved = max(float(np.ptp(record.steer)) for record in records)
    if moved < LEAST_MOTION:
        raise InputError(
            f"the bar moved by {np.degrees(moved):.2f} deg only: is it held, has the drive no "
            "power, or is its friction above the excitation?"
        )
    several = len({record.added_inertia for record in records}) > 1
    found = fit(segments, first_guess(segments), with_ratio=several)
    return _figures(found, confidence, float(np.median(segments[0].steps)))


def _figures(fit: Fit, confidence: float, step: float) -> BarFigures:
    from scipy.stats import t

    freedom = max(fit.pieces - len(fit.free), 1)
    # The larger of both: with few pieces the robust one may by chance be small.
    variance = np.maximum(*(np.diag(one) for one in fit.covariances))
    half = np.zeros(ALL)
    half[fit.free] = np.sqrt(variance) * t.ppf(0.5 + 0.5 * confidence, freedom)
    if not np.isfinite(half).all() or half[0] > 0.5 * fit.guess[0]:
        raise InputError(
            f"no inertia can be told from this: {fit.guess[0]:.3g} ± {half[0]:.2g} kg m²; "
            "a longer or stronger excitation, and hands off the bar"
        )
    _refuse_ends(fit.guess, half)
    half[:3] += _RELATIVE_FLOOR * fit.guess[:3]
    half[3] += _DELAY_FLOOR * step
    figures = {
        name: Figure(name, unit, float(v), float(max(v - h, least)), float(v + h))
        for name, unit, v, h, least in zip(
            Guess._fields, _UNITS, fit.guess, half, LEAST, strict=True
        )
    }
    with_ratio = len(fit.free) == ALL
    ratio = float(fit.guess[-1]) if with_ratio else 1.0
    for name in _BY_TORQUE:
        figures[name] = figures[name].over(ratio)
    return BarFigures(
        figures["inertia"],
        figures["coulomb_friction"],
        figures["viscous_friction"],
        figures["delay"],
        figures["offset"],
        figures["torque_ratio"] if with_ratio else None,
        float(fit.sizes[0]),
        float(fit.sizes[1]),
        confidence,
    )


def _refuse_ends(guess: Reals, half: Reals) -> None:
    """An interval that reaches the end of what was looked for is no answer. Friction and delay may
    be none, and of the moment that friction takes to turn around nothing is told.
    """
    ends = zip(Guess._fields, _UNITS, guess, half, LEAST, MOST, strict=True)
    for name, unit, value, by, least, most in ends:
        below = least != 0.0 and value - by <= least
        if name != "sticking_time" and (below or value + by >= most):
            raise InputError(
                f"the {name.replace('_', ' ')} is not to be found between {least:g} and {most:g} "
                f"{unit}: the fit ends at {value:.3g} ± {by:.2g}; are bench, profile and record "
                "what they should be?"
            )
