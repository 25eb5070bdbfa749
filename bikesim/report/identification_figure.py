"""The figure of an identified rider: his torque, his describing function, his gains."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bikesim.identify.answer import Identification
from bikesim.identify.describing import DescribingFunction
from bikesim.report.style import BLACK, BLUE, GREY, ORANGE, VERMILION, figure, label, styled

_SHOWN = 20.0  # [s] of a ride: more cannot be told apart on a page
_ABOVE: Any = {"loc": "lower right", "bbox_to_anchor": (1, 0.98), "ncols": 4, "borderaxespad": 0}


def identification_figure(found: Identification) -> Figure:
    """Torque measured and modelled; below, describing function and gains with their intervals."""
    with styled():
        drawn = figure(7.2, 6.4)
        parts: Any = drawn.subfigures(2, 1, height_ratios=(1, 1.35))
        upper, lower = parts
        left, right = lower.subfigures(1, 2, width_ratios=(1.25, 1))
        _draw_torque(upper.subplots(), found)
        magnitude, phase = left.subplots(2, 1, sharex=True)
        _draw_describing(magnitude, phase, found)
        _draw_gains(right.subplots(), found)
    return drawn


def _draw_torque(axes: Axes, found: Identification) -> None:
    fit = found.fits[0]
    middle = fit.time[len(fit.time) // 2]
    shown = np.abs(fit.time - middle) <= _SHOWN / 2
    time = fit.time[shown]
    axes.plot(time, fit.measured[shown], color=BLACK, lw=1.0, label="measured")
    axes.plot(time, fit.modelled[shown], color=VERMILION, lw=1.0, label="modelled")
    left_over = (fit.measured - fit.modelled)[shown]
    axes.plot(time, left_over, color=GREY, lw=0.7, label="the rest")
    axes.legend(**_ABOVE)
    first = found.rides[0]
    label(
        axes,
        x="time [s]",
        y="rider torque $T_δ$ [N m]",
        title=f"{found.structure.name}, {first.bicycle.name}, {first.speed:.3g} m/s: "
        f"VAF {found.vaf:.0f} %",
    )


def _draw_describing(magnitude: Axes, phase: Axes, found: Identification) -> None:
    label(magnitude, y="|T/φ| [N m/rad]", title="describing function, roll to torque")
    label(phase, x="frequency ω [rad/s]", y="phase [deg]")
    known = found.describing
    if known is None:
        magnitude.text(
            0.5, 0.5, "no known disturbance:\nit cannot be measured", ha="center", va="center",
            transform=magnitude.transAxes, fontsize=8,
        )  # fmt: skip
        return
    wide = _quantile(found) * known.standard_error
    size = np.abs(known.measured)
    angle, modelled = _phases(known)
    bars: Any = {"fmt": "o", "ms": 3.5, "color": BLACK, "capsize": 2, "lw": 0.9}
    magnitude.loglog(known.model_frequency, np.abs(known.model), color=VERMILION, label="model")
    # A bar of a logarithmic axis must end above zero.
    down = np.minimum(wide, 0.95 * size)
    magnitude.errorbar(known.frequency, size, yerr=np.array([down, wide]), label="measured", **bars)
    phase.semilogx(known.model_frequency, np.degrees(modelled), color=VERMILION)
    spread = np.degrees(np.minimum(wide / size, np.pi))
    phase.errorbar(known.frequency, np.degrees(angle), yerr=spread, **bars)
    magnitude.legend(loc="upper left")


def _phases(known: DescribingFunction) -> tuple[NDArray[Any], NDArray[Any]]:
    """Of the measured points and of the model [rad], the points on the model's branch."""
    modelled = np.unwrap(np.angle(known.model))
    near = np.interp(known.frequency, known.model_frequency, modelled)
    turns = np.round((near - np.angle(known.measured)) / (2 * np.pi))
    return np.angle(known.measured) + 2 * np.pi * turns, modelled


def _draw_gains(axes: Axes, found: Identification) -> None:
    """Each gain over its own value, so that all stand on one axis."""
    names = [f"{gain.name}\n{gain.value:.3g} {gain.unit}" for gain in found.gains]
    rows = np.arange(len(names))[::-1]
    scale = np.array([abs(gain.value) or 1.0 for gain in found.gains])
    sign = np.sign([gain.value for gain in found.gains])
    value, low, high, biased = (
        sign * np.array([getattr(gain, name) for gain in found.gains]) / scale
        for name in ("value", "low", "high", "least_squares")
    )
    wide = np.abs(high - low) / 2
    axes.errorbar(
        value, rows, xerr=wide, fmt="o", ms=4, color=BLUE, capsize=3, label=found.method.value
    )
    axes.plot(biased, rows, "x", color=ORANGE, ms=6, mew=1.6, label="least squares (biased)")
    axes.axvline(0, color=BLACK, lw=0.8)
    # What is not known at all must not squeeze the others.
    least, most = axes.get_xlim()
    axes.set_xlim(max(least, -2.0), min(most, 4.0))
    axes.set_yticks(rows, names, fontsize=8)
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.legend(loc="lower right", bbox_to_anchor=(1.03, 0.99), fontsize=8, borderaxespad=0)
    label(axes, x=f"gain over its value, {100 * found.question.confidence:g} % intervals")


def _quantile(found: Identification) -> float:
    gain = found.gains[0]
    return (gain.high - gain.value) / gain.standard_error
