"""The sampled loop that a bench closes, for its margins; with the haptic cue of a ride in it."""

from collections.abc import Iterator
from dataclasses import replace

from bikesim.bench.profile import BenchSettings
from bikesim.haptics import HapticsSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.sampled_loop import SampledLoop, with_coupling

MOST_DELAY = 0.05
"""A loop with more [s] is not judged: its matrices grow with the delay."""


def bench_loop(
    bench: BenchSettings, bicycle: Bicycle, law: Law, *, coupling: float | None = None
) -> SampledLoop:
    """Of a profile, with its virtual coupling or another share of one. Raises InputError."""
    bar = bench.bar
    loop = SampledLoop(
        bar.inertia,
        period=bench.period,
        delay=bar.delay,
        motor_lag=bar.drive_lag,
        sensor_interval=bar.sensor_interval,
        filter_cutoff=bar.filter_cutoff,
        filter_order=bar.filter_order,
        viscous_friction=bar.viscous_friction,
    )
    share = bar.coupling if coupling is None else coupling
    return with_coupling(loop, share, bicycle, law)


def cued_delay(loop: SampledLoop, haptics: HapticsSettings) -> float:
    """Of the loop with the cue in it [s], which delays by whole periods."""
    return loop.delay + round(haptics.delay / loop.period) * loop.period


def cued_loops(loop: SampledLoop, haptics: HapticsSettings) -> Iterator[SampledLoop]:
    """The loop with each scale that the cue has in a ride, switches included, its filter and its
    delay. What is not judged, see `not_judged`, is taken as what comes nearest.
    """
    scales = {min(max(scale, 0.0), 1.0) for scale in _scales(haptics)}
    # Without torque nothing can shake: of several that one is never the worst.
    for scale in sorted(scales - {0.0} or {0.0}):
        cued = replace(loop, delay=min(cued_delay(loop, haptics), MOST_DELAY), scale=scale)
        if haptics.filter_cutoff is not None:
            cued = replace(
                cued, filter_cutoff=haptics.filter_cutoff, filter_order=haptics.filter_order
            )
        yield cued


def not_judged(loop: SampledLoop, haptics: HapticsSettings) -> str:
    """Why the margins do not tell about such a ride; empty where they do."""
    for scale in _scales(haptics):
        if not 0.0 <= scale <= 1.0:
            why = "reverses the torque" if scale < 0 else "gives more torque than the law"
            return f"haptics: a scale of {scale:g} {why}; with hands on a bar it is to be 0 to 1"
    if haptics.filter_cutoff is not None and loop.filter_cutoff is not None:
        return "haptics.filter_cutoff and bar.filter_cutoff: two filters at once are not judged"
    delay = cued_delay(loop, haptics)
    if delay > MOST_DELAY + 1e-9:
        return (
            f"{1e3 * delay:.0f} ms of delay, that of haptics included: at most "
            f"{1e3 * MOST_DELAY:g} ms is judged"
        )
    return ""


def _scales(haptics: HapticsSettings) -> list[float]:
    return [haptics.scale, *(scale for _, scale in haptics.switches)]
