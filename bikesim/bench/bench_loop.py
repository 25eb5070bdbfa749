"""The sampled loop that a bench closes, for its margins."""

from bikesim.bench.profile import BenchSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.sampled_loop import SampledLoop, with_coupling


def bench_loop(
    bench: BenchSettings, bicycle: Bicycle, law: Law, *, coupling: float | None = None
) -> SampledLoop:
    """Of a profile, with its virtual coupling or another share of one. Raises InputError."""
    bar = bench.bar
    loop = SampledLoop(
        bar.inertia,
        period=bench.period,
        delay=bar.delay,
        viscous_friction=bar.viscous_friction,
    )
    share = bar.coupling if coupling is None else coupling
    return with_coupling(loop, share, bicycle, law)
