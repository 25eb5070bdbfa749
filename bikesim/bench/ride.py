"""A ride on a bench: the loop of the virtual rig, unchanged, on a real bar."""

import math
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bikesim.bench.display import Screen
from bikesim.bench.drives import make_drive
from bikesim.bench.guard import BenchGuard
from bikesim.bench.monitors import Monitor
from bikesim.bench.parts import Parts, Say, loop_port, on_the_bus
from bikesim.bench.preflight import Preflight, check_margins, preflight, told, told_granted
from bikesim.bench.profile import BenchSettings
from bikesim.bench.recorder import ThreadedRecorder
from bikesim.bench.rig import BENCH_CHANNELS
from bikesim.bench.scenario import header_text
from bikesim.bench.stopping import Stopping
from bikesim.bench.wheel_course import WheelCourse, WheelSilent
from bikesim.clock import RealTimeClock
from bikesim.errors import InputError
from bikesim.experiment.course import ScenarioCourse
from bikesim.experiment.scenario import Scenario
from bikesim.haptics import make_haptics
from bikesim.loop import Course, Recorder, Start, ride
from bikesim.realtime import real_time
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending, RunHeader
from bikesim.record.provenance import Provenance
from bikesim.record.writer import RunWriter

# How long another thread may keep the interpreter from the loop [s]; Python's own is 5 ms.
_SWITCH_INTERVAL = 5e-5


@dataclass(frozen=True)
class Order:
    """A ride as a person wants it.

    `scenario` as `bench_scenario` gives it; `pulse`: a commissioning pulse first, hands off;
    `uncommissioned`: without there ever having been one; `without_margin`: how often he said that a
    speed without margin is to be ridden; `frames`: where the bus's raw frames go (BLF).
    """

    name: str
    bench: BenchSettings
    scenario: Scenario
    pulse: bool = False
    uncommissioned: bool = False
    without_margin: int = 0
    frames: Path | None = None


def check_order(order: Order) -> Preflight:
    """What can be known without a bus. Raises InputError."""
    bench = order.bench
    ready = preflight(bench, order.scenario, make_drive(bench.drive))
    check_margins(ready, told=order.without_margin)
    proven = bench.commissioned == bench.commissioning
    if not (proven or order.pulse or order.uncommissioned):
        never = "its bus, bar or drive changed since" if bench.commissioned else "it never passed"
        raise InputError(
            f"fault 22: {order.name}: {never} the commissioning pulse: bikesim bench check "
            f"{order.name} --pulse, hands off the bar (or --pulse, or --uncommissioned)"
        )
    return ready


class Ridden(NamedTuple):
    """How a ride ended; `stopped`: whether somebody asked for that, whatever else happened.

    `mean_square` [(N m)²]: of the torque lately, as the guard has it of the motor's warmth.
    """

    ending: Ending
    stopped: bool
    mean_square: float


def ride_once(
    order: Order,
    ready: Preflight,
    screen: Screen,
    output: Path,
    *,
    force: bool,
    say: Say,
    mean_square: float = 0.0,
) -> Ridden:
    """Arm, ramp in, ride, ramp out, disable; recorded in `output`. Raises InputError.

    `mean_square` [(N m)²]: of the motor's torque, of a ride before.
    """
    bench = order.bench
    header = RunHeader(
        scenario=header_text(bench, order.scenario),
        bicycle=ready.bicycle,
        law=order.scenario.law,
        handlebar_inertia=bench.bar.inertia,
        rig="bench",
        rider="person",
        seed=order.scenario.seed,
        provenance=Provenance.gather(),
    )
    drive = make_drive(bench.drive)
    with (
        on_the_bus(bench, drive, say, plan=told(ready)) as bus,
        RunWriter(
            output,
            channels=(*TICK_CHANNELS, *BENCH_CHANNELS),
            period=bench.period,
            planned_ticks=order.scenario.ticks + round(1 / bench.period),
            header=header,
            force=force,
        ) as writer,
    ):
        recorder = ThreadedRecorder(writer, order.frames, say)
        with real_time() as granted, recorder, _prompt_threads():
            for line in told_granted(granted):
                say(line)
            port = loop_port(bus, bench, drive, recorder.log)
            parts = Parts(bench, drive, port, RealTimeClock(bench.period))
            try:
                ride = Ride(order, ready, parts, recorder, [recorder.failed], mean_square)
                ending, stopped = _armed_ride(ride, screen, say)
            finally:
                parts.rig.close()
                _warn(parts, say)
        recorder.finish(ending)
    return Ridden(ending, stopped, ride.guard.mean_square)


def _warn(parts: Parts, say: Say) -> None:
    """Of a drive that may have power still, however the ride was left."""
    if parts.rig.disabled is not True:
        say(f"WARNING  {parts.drive.name} did not say that it is disabled: cut its power")


def _armed_ride(ride: "Ride", screen: Screen, say: Say) -> tuple[Ending, bool]:
    """Nothing here may take long: the drive listens for its host."""
    parts, order = ride.parts, ride.order
    screen.say("the drive is being armed")
    say(f"arming   {parts.drive.name}; its torque will ramp in over {ride.ramp_in:g} s")
    parts.arm()
    if order.pulse:
        screen.say("commissioning pulse: hands off the bar")
    pulse = parts.pulse() if order.pulse else None
    parts.rig.hooks = parts.rig.hooks._replace(show=screen.show)
    stopping = Stopping(ride.guard.ask_to_stop)
    with stopping.watching():
        ending = ride.go(stopping)
        # At once: a display must not show one that fell for as long as files take to close.
        (screen.stand if ending.fell else screen.say)(ending.reason)
    if pulse is not None:
        say(pulse)
    return ending, stopping.asked


class Ride:
    """Everything of a ride, made before the drive is armed."""

    def __init__(
        self,
        order: Order,
        ready: Preflight,
        parts: Parts,
        record: Recorder,
        more: Iterable[Monitor] = (),
        mean_square: float = 0.0,
    ) -> None:
        """`more` look for faults besides; `mean_square` [(N m)²]: of the motor's torque before."""
        scenario, bench = order.scenario, order.bench
        self.order, self.parts = order, parts
        self.ramp_in = bench.thresholds.ramp_in
        course: Course = ScenarioCourse(scenario, ready.bicycle)
        course.disturbance(0.0)
        wheel: list[Monitor] = []
        if parts.wheel is not None:
            course = WheelCourse(parts.wheel, course, bench.limits.speed)
            wheel = [WheelSilent(parts.wheel, bench.thresholds.wheel_silent)]
        self.guard = BenchGuard(
            bench.limits,
            bench.thresholds,
            period=bench.period,
            heartbeat_period=parts.drive.heartbeat_period,
            observe=parts.rig.observation,
            end=scenario.duration - 0.5 * bench.period,
            more=[*wheel, *more],
            mean_square=mean_square,
        )
        self._record, self._course, self._haptic = record, course, ready.haptic
        self._haptics = make_haptics(scenario.haptics, bench.period)
        start = scenario.start
        self._start = Start(
            math.radians(start.roll_deg),
            math.radians(start.roll_rate_deg_s),
            math.radians(start.heading_deg),
        )
        # The guard ends it, by the time; more ticks are there for the case that it does not.
        self._ticks = scenario.ticks + round((bench.thresholds.ramp_out + 1.0) / bench.period)

    def go(self, interrupted: Callable[[], bool] = lambda: False) -> Ending:
        """The loop, on a rig that is armed; the rig is closed afterwards."""
        rig, guard = self.parts.rig, self.guard
        rig.hooks = rig.hooks._replace(fault=lambda: guard.row)
        rig.begin()
        return ride(
            rig,
            self._haptic,
            guard,
            self._record,
            course=self._course,
            start=self._start,
            ticks=self._ticks,
            haptics=self._haptics,
            interrupted=interrupted,
        )


@contextmanager
def _prompt_threads() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_INTERVAL)
    try:
        yield
    finally:
        sys.setswitchinterval(before)
