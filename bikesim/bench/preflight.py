"""What is known of a ride on a bench before anything is sent: said, or refused."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bikesim.bench.bench_loop import bench_loop, cued_delay, cued_loops, not_judged
from bikesim.bench.bus import bus_load
from bikesim.bench.drive import Drive
from bikesim.bench.faults import weaker
from bikesim.bench.profile import BenchSettings
from bikesim.errors import InputError
from bikesim.experiment.run import scenario_bicycle
from bikesim.experiment.scenario import Scenario
from bikesim.haptics import HapticsSettings, make_haptics
from bikesim.model.bicycle import Bicycle
from bikesim.model.coupling import CoupledBicycle, Coupling
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
    """Bicycle, loop and margins of a ride; `load` of the bus at worst.

    `margins` with the haptic cue in the loop, up to the first speed without; `delay` [s], that of
    the cue included; `doubt`: why the margins do not tell about this ride, or empty; `cued`:
    whether there is a cue.
    """

    bench: BenchSettings
    bicycle: Bicycle
    law: Law
    wanted_inertia: float
    coupling: Coupling | None
    load: float
    margins: tuple[Margin, ...]
    delay: float = 0.0
    doubt: str = ""
    cued: bool = False

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
    """For a scenario as `bench_scenario` gives it. Raises InputError for a bus that is too slow,
    and a haptic cue that the period cannot carry.
    """
    bicycle, law = scenario_bicycle(scenario), Law(scenario.law)
    load, haptics = checked_load(bench, drive), scenario.haptics
    make_haptics(haptics, bench.period)
    loop = bench_loop(bench, bicycle, law)
    return Preflight(
        bench,
        bicycle,
        law,
        handlebar_inertia(bicycle, law),
        loop.coupling,
        load,
        _margins(bicycle, law, loop, haptics, _speeds(bench, scenario)),
        cued_delay(loop, haptics),
        not_judged(loop, haptics),
        haptics != HapticsSettings(),
    )


def _margins(
    bicycle: Bicycle,
    law: Law,
    loop: SampledLoop,
    haptics: HapticsSettings,
    speeds: Sequence[float],
) -> tuple[Margin, ...]:
    """From the fastest on: one without margin is enough to know."""
    found: list[Margin] = []
    for speed in sorted(speeds, reverse=True):
        for cued in cued_loops(loop, haptics):
            found.append(margin_at(bicycle, law, speed, cued, GRIPS))
            if not found[-1].is_there:
                return tuple(found)
    return tuple(found)


_SPEED_STEP = 0.5  # m/s; a light bar with a coupling may lack margin in the middle only


def _speeds(bench: BenchSettings, scenario: Scenario) -> list[float]:
    """All of the ride; with a sensor at the wheel, from standing to the fastest let in [m/s]."""
    profile = [speed for _, speed in scenario.speed_profile] or [scenario.speed]
    low, high = min(profile), max(profile)
    if bench.wheel is not None:
        low, high = 0.0, bench.limits.speed
    steps = math.ceil((high - low) / _SPEED_STEP)
    return [low + i * (high - low) / max(steps, 1) for i in range(steps + 1)]


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


_ALL_THE_SAME = "--without-margin, given twice, rides all the same"


def check_margins(ready: Preflight, *, told: int) -> None:
    """Raises InputError for a speed without margin, or a haptic cue for which none can be judged,
    unless it was `told` twice to ride it.
    """
    worst = ready.worst
    if told >= 2 or (worst.is_there and not ready.doubt):
        return
    if ready.doubt:
        raise InputError(f"{ready.doubt}; {_ALL_THE_SAME}")
    raise InputError(f"{_none(ready)}; see bikesim bench margins; {_ALL_THE_SAME}")


def _none(ready: Preflight) -> str:
    worst = ready.worst
    grip = worst.grip
    why = (
        f"hands off it is unstable, {-1e3 * worst.delay_margin:.0f} ms of delay too many"
        if worst.delay_margin <= 0
        else f"a mode {worst.excess:.2g} 1/s less stable than the bicycle's (allowed "
        f"{ALLOWED_EXCESS:g}), at arms of {grip.inertia:g} kg m², {grip.damping:g} N m s/rad, "
        f"{grip.stiffness:g} N m/rad"
    )
    cue = ", haptics as in the scenario" if ready.cued else ""
    return (
        f"no margin at {worst.speed:g} m/s with {ready.bench.bar.inertia:.4g} kg m² and "
        f"{1e3 * ready.delay:g} ms of delay{cue}: {why}"
    )


def told(ready: Preflight) -> list[str]:
    """What a ride will do, for the person who is about to hold the bar."""
    bench = ready.bench
    limits = bench.limits
    lines = [
        f"rate     {1 / bench.period:g} Hz, bus load at most {100 * ready.load:.0f} % of "
        f"{bench.bus.bitrate / 1000:g} kbit/s",
        f"margin   {ready.doubt or _margin(ready)}",
        f"limits   {limits.torque:g} N m, {limits.torque_rate:g} N m/s, "
        f"{limits.continuous_torque:g} N m RMS, {bench.thresholds.trip_angle_deg:g} deg, "
        f"{bench.thresholds.trip_rate:g} rad/s",
        _drive_limits(bench),
        *_senses(bench),
        *_weaker(bench),
        f"inertia  {_inertia(ready)}",
    ]
    return lines


def _drive_limits(bench: BenchSettings) -> str:
    drive = bench.drive
    return (
        f"drive    told to keep to {drive.torque_limit:g} N m and {drive.speed_limit:g} rad/s "
        f"at the bar; disables itself when the host is silent for {1e3 * drive.watchdog:g} ms"
    )


def _senses(bench: BenchSettings) -> list[str]:
    if bench.bar.source == "node":
        return []
    return [
        "NOT      rows 2 to 6 and 21 of the faults: steer is the drive's encoder, without a second "
        "sensor; the host does not see the emergency stop"
    ]


def _weaker(bench: BenchSettings) -> list[str]:
    found = weaker(bench.thresholds)
    return [f"weaker   {', '.join(found)}; a real bench keeps the defaults"] if found else []


def _margin(ready: Preflight) -> str:
    worst = ready.worst
    if not worst.is_there:
        return _none(ready)
    left = "no delay makes it unstable"
    if worst.delay_margin < math.inf:
        left = f"{1e3 * worst.delay_margin:.0f} ms more delay, hands off"
    return (
        f"{left} at {worst.speed:g} m/s, {ready.bench.bar.inertia:.4g} kg m² and "
        f"{1e3 * ready.delay:g} ms"
    )


def _inertia(ready: Preflight) -> str:
    bar = ready.bench.bar
    felt = bar.inertia + (ready.coupling.inertia if ready.coupling else 0.0)
    coupled = f" with a virtual coupling: {felt:.4g}" if ready.coupling else ""
    return (
        f"{bar.inertia:.4g} kg m²{coupled}; the law asks for {ready.wanted_inertia:.4g}: an "
        f"eigenvalue {ready.worst.inertia_error:.2g} 1/s off the bicycle's"
    )


def told_granted(granted: Granted) -> list[str]:
    """What of real time the operating system grants a ride."""
    refused = [
        f"{name.replace('_', ' ')} refused ({why})"
        for name, why in zip(granted._fields, granted, strict=True)
        if why is not None
    ]
    got = [n.replace("_", " ") for n, why in zip(granted._fields, granted, strict=True) if not why]
    lines = [f"granted  {', '.join(got) or 'nothing'}"]
    return [*lines, *(f"NOT      {one}" for one in refused)]
