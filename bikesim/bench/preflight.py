"""What is known of a ride on a bench before anything is sent: said, or refused."""

from dataclasses import dataclass

from bikesim.bench.bus import bus_load
from bikesim.bench.drive import Drive
from bikesim.bench.profile import BenchSettings
from bikesim.errors import InputError
from bikesim.experiment.run import scenario_bicycle
from bikesim.experiment.scenario import Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.model.coupling import CoupledBicycle, Coupling, virtual_coupling
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.margins import ALLOWED_EXCESS, GRIPS, Margin, margin_at
from bikesim.model.sampled_loop import SampledLoop
from bikesim.model.simulator import handlebar_inertia
from bikesim.realtime import Granted

MOST_LOAD = 0.9
"""Of a bus, at worst; above it frames begin to come late."""

_NODE_FRAMES = ((8, 1000.0), (8, 50.0))  # bytes, Hz: SteerState, SteerDiag
_WHEEL_FRAMES = ((8, 100.0),)


@dataclass(frozen=True)
class Preflight:
    """Bicycle, loop and margins of a ride; `load` of the bus at worst."""

    bench: BenchSettings
    bicycle: Bicycle
    law: Law
    wanted_inertia: float
    coupling: Coupling | None
    load: float
    margins: tuple[Margin, ...]

    @property
    def haptic(self) -> HapticBicycle:
        """What the loop steps."""
        if self.coupling is None:
            return HapticBicycle(self.bicycle, self.law)
        return CoupledBicycle(self.bicycle, self.law, self.coupling)

    @property
    def worst(self) -> Margin:
        """The margins where they are least."""
        return min(self.margins, key=lambda one: (one.is_there, one.delay_margin))


def preflight(bench: BenchSettings, scenario: Scenario, drive: Drive) -> Preflight:
    """For a scenario as `bench_scenario` gives it. Raises InputError for a bus that is too slow."""
    bicycle, law = scenario_bicycle(scenario), Law(scenario.law)
    wanted = handlebar_inertia(bicycle, law)
    coupling = virtual_coupling(
        bench.bar.coupling,
        inertia=bench.bar.inertia,
        wanted=wanted,
        delay=bench.bar.delay,
        period=bench.period,
    )
    loop = SampledLoop(
        bench.bar.inertia,
        period=bench.period,
        delay=bench.bar.delay,
        viscous_friction=bench.bar.viscous_friction,
        coupling=coupling,
    )
    margins = tuple(margin_at(bicycle, law, one, loop, GRIPS) for one in _speeds(bench, scenario))
    return Preflight(bench, bicycle, law, wanted, coupling, checked_load(bench, drive), margins)


def _speeds(bench: BenchSettings, scenario: Scenario) -> list[float]:
    """Those of the ride; with a sensor at the wheel, up to the fastest that is let in."""
    if bench.wheel is not None:
        top = bench.limits.speed
        return [0.25 * top, 0.5 * top, top]
    profile = [speed for _, speed in scenario.speed_profile]
    return sorted({min(profile), max(profile)}) if profile else [scenario.speed]


def checked_load(bench: BenchSettings, drive: Drive) -> float:
    """Of the bus, by all frames of the profile's devices. Raises InputError where it is too much.

    A bus without a bit rate of its own is judged as if it had the profile's.
    """
    node = _NODE_FRAMES if bench.bar.source == "node" else ()
    wheel = _WHEEL_FRAMES if bench.wheel is not None else ()
    frames = (*drive.traffic(bench.period), *node, *wheel)
    load = bus_load(frames, bench.bus.bitrate)
    if load > MOST_LOAD:
        raise InputError(
            f"{1 / bench.period:g} Hz does not fit on {bench.bus.bitrate / 1000:g} kbit/s: the bus "
            f"would be loaded to {100 * load:.0f} %, allowed {100 * MOST_LOAD:.0f} %; a longer "
            "period, or a faster bus"
        )
    return load


def check_margins(ready: Preflight, *, told: int) -> None:
    """Raises InputError for a speed without margin, unless it was `told` twice to ride it."""
    worst = ready.worst
    if worst.is_there or told >= 2:
        return
    grip = worst.grip
    why = (
        f"hands off it is unstable, {-1e3 * worst.delay_margin:.0f} ms of delay too many"
        if worst.delay_margin <= 0
        else f"a mode {worst.excess:.2g} 1/s less stable than the bicycle's (allowed "
        f"{ALLOWED_EXCESS:g}), at arms of {grip.inertia:g} kg m², {grip.damping:g} N m s/rad, "
        f"{grip.stiffness:g} N m/rad"
    )
    raise InputError(
        f"no margin at {worst.speed:g} m/s with {ready.bench.bar.inertia:.4g} kg m² and "
        f"{1e3 * ready.bench.bar.delay:g} ms of delay: {why}; see bikesim bench margins; "
        "--without-margin, given twice, rides all the same"
    )


def told(ready: Preflight, granted: Granted) -> list[str]:
    """What a ride will do, for the person who is about to hold the bar."""
    bench, worst = ready.bench, ready.worst
    limits = bench.limits
    lines = [
        f"rate     {1 / bench.period:g} Hz, bus load at most {100 * ready.load:.0f} % of "
        f"{bench.bus.bitrate / 1000:g} kbit/s",
        f"margin   {_margin(worst)} at {worst.speed:g} m/s, {bench.bar.inertia:.4g} kg m² and "
        f"{1e3 * bench.bar.delay:g} ms",
        f"limits   {limits.torque:g} N m, {limits.torque_rate:g} N m/s, "
        f"{limits.continuous_torque:g} N m RMS, {bench.thresholds.trip_angle_deg:g} deg, "
        f"{bench.thresholds.trip_rate:g} rad/s",
        f"inertia  {_inertia(ready)}",
        *_granted(granted),
    ]
    return lines


def _margin(worst: Margin) -> str:
    if worst.delay_margin == float("inf"):
        return "no delay makes it unstable"
    return f"{1e3 * worst.delay_margin:.0f} ms more delay, hands off"


def _inertia(ready: Preflight) -> str:
    bar = ready.bench.bar
    felt = bar.inertia + (ready.coupling.inertia if ready.coupling else 0.0)
    coupled = f" with a virtual coupling: {felt:.4g}" if ready.coupling else ""
    return (
        f"{bar.inertia:.4g} kg m²{coupled}; the law asks for {ready.wanted_inertia:.4g}: an "
        f"eigenvalue {ready.worst.inertia_error:.2g} 1/s off the bicycle's"
    )


def _granted(granted: Granted) -> list[str]:
    refused = [
        f"{name.replace('_', ' ')} refused ({why})"
        for name, why in zip(granted._fields, granted, strict=True)
        if why is not None
    ]
    got = [n.replace("_", " ") for n, why in zip(granted._fields, granted, strict=True) if not why]
    lines = [f"granted  {', '.join(got) or 'nothing'}"]
    return [*lines, *(f"NOT      {one}" for one in refused)]
