"""How long riders stay up: the Kaplan-Meier estimate, runs that stayed up censored."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.report.experiment.rates import CONFIDENCE, normal_quantile

Reals = NDArray[np.floating[Any]]


class Survival(NamedTuple):
    """S(t), the share still up just after each `time` [s] of a fall, (n,), with its band.

    `at_risk` and `falls` at each. Before the first time S is 1. `last` [s] is the longest ride.
    `median` [s] is the first time with S ≤ 0.5, NaN if there is none; its interval is where the
    band holds 0.5 [Brookmeyer & Crowley 1982], infinite above where that does not end, NaN below
    where it does not begin.
    """

    time: Reals
    share: Reals
    low: Reals
    high: Reals
    at_risk: NDArray[np.int64]
    falls: NDArray[np.int64]
    last: float
    median: float
    median_low: float
    median_high: float

    def quantile(self, share: float) -> float:
        """The first time [s] by which this share has fallen; NaN where it was not reached."""
        return _first(self.time, self.share <= 1 - share + _ROUNDING)


def ridden(duration: Reals, fall_time: Reals) -> Reals:
    """Until when each was seen up [s]: his fall, or else the end of his ride.

    A ride is over with the tick of the fall, which is one period after the time of the fall.
    """
    return np.where(np.isfinite(fall_time), fall_time, duration)


def kaplan_meier(
    duration: Reals, fell: NDArray[np.bool_], confidence: float = CONFIDENCE
) -> Survival:
    """The product-limit estimate of rides (m,) seen up so long [s], and then fallen or not.

    Band: Greenwood's variance of log(-log S), point by point [Kaplan & Meier 1958; Kalbfleisch &
    Prentice 2002, sec. 1.4]. Where S is 0 there is none.
    """
    time, falls = np.unique(duration[fell], return_counts=True)
    at_risk = len(duration) - np.searchsorted(np.sort(duration), time, side="left")
    share = np.cumprod(1 - falls / at_risk)
    with np.errstate(divide="ignore", invalid="ignore"):
        greenwood = np.cumsum(falls / (at_risk * (at_risk - falls)))
        theta = normal_quantile(confidence) * np.sqrt(greenwood) / np.abs(np.log(share))
        low, high = share ** np.exp(theta), share ** np.exp(-theta)
    none = share <= 0
    low[none], high[none] = np.nan, np.nan
    # Where all have fallen there is no band; the estimate itself is below any limit.
    begins, ends = np.where(none, share, low) <= 0.5 + _ROUNDING, high < 0.5 - _ROUNDING
    end = _first(time, ends)
    return Survival(
        time, share, low, high, at_risk, falls,
        last=float(duration.max()) if len(duration) else math.nan,
        median=_first(time, share <= 0.5 + _ROUNDING),
        median_low=_first(time, begins), median_high=math.inf if math.isnan(end) else end,
    )  # fmt: skip


_ROUNDING = 1e-12


def _first(time: Reals, there: NDArray[np.bool_]) -> float:
    return float(time[there.argmax()]) if there.any() else math.nan
