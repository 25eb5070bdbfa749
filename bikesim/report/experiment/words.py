"""Figures as a person reads them."""

import math
import re
from collections.abc import Sequence

from bikesim.experiment.metric_table import Metric
from bikesim.report.experiment.logistic import Term


def number(value: float, digits: int = 3) -> str:
    """To so many significant digits; a dash for one that is not there."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else ("∞" if value > 0 else "−∞")
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")  # 9.996 has one digit more before the point
    places = digits - 1 - math.floor(math.log10(abs(rounded)))
    if places > digits + 3 or places < -3:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    return f"{rounded:.{max(places, 0)}f}".replace("-", "−")


def percent(share: float) -> str:
    """A share in percent, to a tenth where that is seen."""
    if math.isnan(share):
        return "–"
    value = 100 * share
    whole = abs(value - round(value)) < 0.05
    return (f"{value:.0f}" if whole else f"{value:.1f}").replace("-", "−")


def p_value(p: float) -> str:
    """Such as 0.012, or < 0.001."""
    if math.isnan(p):
        return "–"
    return "< 0.001" if p < 0.001 else f"{p:.3f}" if p < 0.1 else f"{p:.2f}"


def interval(middle: float, low: float, high: float, factor: float = 1.0) -> str:
    """A value with its interval, each an element of the page: 1.5 [1.2, 1.9]."""
    shown = [number(factor * value) for value in (middle, low, high)]
    if math.isnan(middle):
        return "–"
    if math.isnan(low) and math.isnan(high):
        return f"<span>{shown[0]}</span>"
    return f"<span>{shown[0]}</span> <span>[{shown[1]}, {shown[2]}]</span>"


def fall_time(median: float, low: float, high: float) -> str:
    """The time by which half have fallen [s], each an element of the page."""
    return "<span>not reached</span>" if math.isnan(median) else interval(median, low, high)


def odds(term: Term) -> str:
    """The odds ratio of a term, with its interval."""
    return interval(*(_exp(value) for value in (term.estimate, term.low, term.high)))


def _exp(value: float) -> float:
    return math.exp(value) if value < 700 else math.inf


def plain(name: str) -> str:
    """A column's name as words."""
    return " ".join(_ABBREVIATED.get(word, word) for word in name.split("_"))


_ABBREVIATED = {"rms": "RMS", "sdlp": "SDLP"}


def unbroken(text: str) -> str:
    """Such as: speed 2.5 m/s, the unit kept on the line of its number."""
    return re.sub(r"(?<=\d) (?=\S+?(,|$))", "\N{NO-BREAK SPACE}", text)


def headed(metric: Metric) -> str:
    """A metric with its unit, for the head of a column."""
    unit = metric.shown_unit
    return f"{plain(metric.name)} [{unit}]" if unit else plain(metric.name)


def listed(words: Sequence[str]) -> str:
    """a, b and c."""
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
