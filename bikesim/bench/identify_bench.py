"""Exciting the bar of a real bench, and what of the answer goes into its profile."""

import math
from collections.abc import Callable, Sequence

from bikesim.bench.drives import make_drive
from bikesim.bench.guard import BenchGuard
from bikesim.bench.identify import BarFigures
from bikesim.bench.identify_excitation import MOST_RATE, Excitation, excite
from bikesim.bench.identify_model import BarRecord
from bikesim.bench.parts import Parts, Say, loop_port, on_the_bus
from bikesim.bench.profile import BenchSettings
from bikesim.bench.pulse import GROSSLY, send_pulse
from bikesim.bench.stopping import Stopping
from bikesim.clock import RealTimeClock
from bikesim.model.haptic import BicycleState
from bikesim.realtime import real_time

_AT_REST = BicycleState(*(0.0 for _ in BicycleState._fields))


def excite_bench(
    bench: BenchSettings,
    excitation: Excitation,
    added: Sequence[float],
    *,
    ask: Callable[[str], object],
    say: Say = print,
) -> list[BarRecord]:
    """A record for each `added` inertia [kg m²], which a person puts on when `ask` says so.

    Each time the drive is set up, its watchdog proven, armed, and disabled at the end. Raises
    InputError.
    """
    records = []
    for inertia in added:
        weights = f"put {inertia:g} kg m² of weights on the bar" if inertia else "no weights"
        ask(f"bar straight and free, {weights}, HANDS OFF; then Enter")
        drive = make_drive(bench.drive)
        with on_the_bus(bench, drive, say) as bus, real_time():
            port = loop_port(bus, bench, drive)
            parts = Parts(bench, drive, port, RealTimeClock(bench.period))
            try:
                parts.arm()
                records.append(excite_armed(parts, excitation, inertia))
            finally:
                parts.rig.close()
        if parts.rig.disabled is not True:
            say(f"WARNING  {drive.name} did not say that it is disabled: cut its power")
    return records


def excite_armed(parts: Parts, excitation: Excitation, added_inertia: float = 0.0) -> BarRecord:
    """On parts that are armed, the guard in force; the rig is its owner's to close.

    A pulse before shows that signs, units and gear are right; raises InputError where they are not.
    """
    bench, rig = parts.bench, parts.rig
    _prove(parts, excitation.torque, added_inertia)
    guard = BenchGuard(
        bench.limits,
        bench.thresholds,
        period=bench.period,
        heartbeat_period=parts.drive.heartbeat_period,
        observe=rig.observation,
    )
    rig.begin()
    with Stopping(guard.ask_to_stop).watching():
        return excite(rig, guard, excitation, _AT_REST, added_inertia=added_inertia)


def _prove(parts: Parts, torque: float, added_inertia: float) -> None:
    """What the bar is will be seen: only what is grossly wrong is looked for, with less torque."""
    bench, bar = parts.bench, parts.bench.bar
    send_pulse(
        parts.rig,
        bar.model_copy(update={"inertia": bar.inertia + added_inertia}),
        bench.limits,
        bench.thresholds.model_copy(update={"trip_rate": MOST_RATE}),
        parts.drive.heartbeat_period,
        torque=min(torque, bench.limits.torque),
        allowed=GROSSLY,
    )


def proposed(figures: BarFigures) -> dict[str, float]:
    """What a profile should have, as "table.key": the digits that the intervals bear.

    Of the delay the upper end, as margins are not to be hoped for.
    """
    bar = (figures.inertia, figures.coulomb_friction, figures.viscous_friction)
    entries = {f"bar.{one.name}": _rounded(one.value, one.half) for one in bar}
    return {**entries, "bar.delay": math.ceil(1e5 * figures.delay.high) / 1e5}


def _rounded(value: float, half: float) -> float:
    """To a digit more than the interval's first."""
    return round(value, max(0, 1 - math.floor(math.log10(half)))) if half > 0 else value
