"""When the paper's conclusion holds: what the maps say."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import eigenvalues
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.report.paper.claims import Claim
from bikesim.report.paper.stability_map import (
    ARM_INERTIA,
    SPEED,
    VISUAL_DELAY,
    Check,
    Condition,
    StabilityMap,
    solve_cell,
)
from bikesim.rider.base import Arms

SOFT_ARMS = Arms(ARM_INERTIA, 2.0, 5.0)  # the default rider's
STIFF_ARMS = Arms(ARM_INERTIA, 4.0, 20.0)


def map_claims(bicycle: Bicycle, delays: StabilityMap, checks: Sequence[Check]) -> list[Claim]:
    """From the map over delay and stiffness, two single cases, a proof, and rides."""
    return [
        _no_third_power(bicycle, delays),
        _soft_arms(bicycle),
        _law_of_nature(bicycle, delays),
        _checks(checks),
    ]


def zero_crossings(found: StabilityMap, law: Law) -> list[float | None]:
    """For each column the least stiffness from which the law is stabilisable; None if it is not.

    Linear between the map's rows; 0 where it is so in the first row already.
    """
    return [
        _first_below_zero(found.stiffnesses, rates) for rates in found.growth_rates(law).T.tolist()
    ]


def _first_below_zero(stiffnesses: Sequence[float], rates: Sequence[float]) -> float | None:
    if rates[0] < 0:
        return stiffnesses[0]
    for i in range(1, len(rates)):
        if rates[i] < 0:
            share = rates[i - 1] / (rates[i - 1] - rates[i])
            return stiffnesses[i - 1] + share * (stiffnesses[i] - stiffnesses[i - 1])
    return None


def _no_third_power(bicycle: Bicycle, delays: StabilityMap) -> Claim:
    """With T_f = 0, s⁴ + 0 s³ + ...: the sum of the four eigenvalues is 0 for any gains."""
    mass, damping, stiffness = simulator_matrices(bicycle, Law.OFF, SPEED)

    def closed(gains: Iterable[float]) -> NDArray[np.complex128]:
        roll, roll_rate = gains
        return eigenvalues(
            mass, damping - [[0, 0], [roll_rate, 0]], stiffness - [[0, 0], [roll, 0]]
        )

    grid = [(roll, rate) for roll in np.linspace(-50, 50, 21) for rate in np.linspace(-50, 50, 21)]
    sums = [float(abs(closed(gains).sum())) for gains in grid]
    least = min(
        float(minimize(lambda g: closed(g).real.max(), start, method="Nelder-Mead", tol=1e-10).fun)
        for start in ((0.3, 0.7), (-0.3, -0.7), (5.0, 5.0), (-5.0, 5.0))
    )
    free = delays.growth_rates(Law.OFF)[0]
    return Claim(
        "Free arms, haptics off: no roll PD rider balances (no s³ term)",
        None,
        f"least growth {least:+.2f} 1/s",
        least > 0 and max(sums) < 1e-9,
        "Without lag and delay the eigenvalues' sum, the s³ term, is 0 for any gains (here within "
        f"{max(sums):.0e} for {len(sums)} pairs up to ±50), so they cannot all be in the left "
        f"half. With muscles and delay the least growth of any gains is {free.min():+.2f} to "
        f"{free.max():+.2f} 1/s.",
    )


def _soft_arms(bicycle: Bicycle) -> Claim:
    cell = solve_cell(bicycle, Condition(VISUAL_DELAY, SOFT_ARMS))
    on, off = cell.on.growth_rate, cell.off.growth_rate
    return Claim(
        f"Soft arms (2 N m s/rad, 5 N m/rad), delay {VISUAL_DELAY} s: balanced with haptics only",
        None,
        f"on {on:+.3f}, off {off:+.3f} 1/s",
        on < 0 < off,
        "Least growth rates of any roll PD rider, gains of any sign; with haptics on at "
        f"({cell.on.roll_gain:.3f} N m/rad, {cell.on.roll_rate_gain:.3f} N m s/rad).",
    )


def _law_of_nature(bicycle: Bicycle, delays: StabilityMap) -> Claim:
    on, off = delays.growth_rates(Law.PAPER), delays.growth_rates(Law.OFF)
    separates = int(((on < 0) & (off > 0)).sum())
    both = int(((on < 0) & (off < 0)).sum())
    stiff = solve_cell(bicycle, Condition(VISUAL_DELAY, STIFF_ARMS))
    return Claim(
        "Haptics off, nobody stabilises 3.5 m/s",
        "cannot",
        f"so in {separates} of {on.size} cells of the map",
        both == 0 and separates > 0,
        f"Not a law of nature: it holds for loose arms or late eyes. In {both} cells some roll PD "
        f"rider balances with haptics off as well, in {on.size - separates - both} none even with "
        f"haptics on. Haptics off balances from an arm stiffness [N m/rad] of {_by_delay(delays)} "
        f"(damping 0.2 s of it). Stiff arms (4 N m s/rad, 20 N m/rad), delay {VISUAL_DELAY} s: on "
        f"{stiff.on.growth_rate:+.2f}, off {stiff.off.growth_rate:+.2f} 1/s.",
    )


def _by_delay(delays: StabilityMap) -> str:
    crossings = zero_crossings(delays, Law.OFF)
    every = max(1, (len(delays.columns) - 1) // 4)
    shown = list(zip(delays.columns, crossings, strict=True))[::every]
    most = delays.stiffnesses[-1]
    return ", ".join(
        (f"over {most:g}" if stiffness is None else f"{stiffness:.1f}") + f" at {delay:.2g} s delay"
        for delay, stiffness in shown
    )


def _checks(checks: Sequence[Check]) -> Claim:
    agreeing = sum(check.agrees for check in checks)
    grew = sum(check.roll.grew for check in checks)
    return Claim(
        "The virtual rig does what the linear map says",
        None,
        f"{agreeing} of {len(checks)} rides agree",
        agreeing == len(checks),
        f"The best rider of a cell: roll grew in {grew}, died out in {len(checks) - grew}. Cells "
        "within 0.1 1/s of the limit are left out. What dies out may first rise, up to "
        f"{_highest_peak(checks):.0f} times the roll at the start: near the limit a cell is "
        "stabilisable in theory only.",
    )


def _highest_peak(checks: Sequence[Check]) -> float:
    return max((check.roll.peak_ratio for check in checks if not check.roll.grew), default=1.0)
