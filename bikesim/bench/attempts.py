"""Ride after ride on a bench: a bicycle that fell stands upright again (row 23).

A fall has ended the ride: the torque ramped out, the drive disabled, the record closed. What comes
next is a ride like the first, with a record of its own, everything checked and the drive armed
anew; and only once whoever holds the bar has asked for it, with the bar.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from time import monotonic

from bikesim.bench.asking import ASK, Asking
from bikesim.bench.display import Screen, screen_name
from bikesim.bench.drives import make_drive
from bikesim.bench.parts import Parts, Say, loop_port, on_the_bus
from bikesim.bench.profile import BenchSettings
from bikesim.bench.ride import Order, check_order, ride_once
from bikesim.bench.showing import showing_of
from bikesim.clock import RealTimeClock
from bikesim.errors import InputError

_NO_DISPLAY = nullcontext()
_SILENT = 1.0  # s without a good sample, of which the person is told


def attempt_file(output: Path, attempt: int) -> Path:
    """ride.h5, ride-2.h5, ride-3.h5…"""
    return output if attempt == 1 else output.with_stem(f"{output.stem}-{attempt}")


def run_bench(
    order: Order,
    output: Path,
    *,
    attempts: int = 1,
    force: bool = False,
    say: Say = print,
    display: AbstractContextManager[object] = _NO_DISPLAY,
) -> Iterator[Path]:
    """Arm, ramp in, ride, ramp out, disable; recorded in `output`. Gives each record.

    After a fall again, up to `attempts` in all, see `attempt_file`; not if anybody asked to stop,
    whenever in the ride that was. Ctrl-C while it waits for the next one ends it. `display` is
    entered when there is something to look at, before anything is on the bus. Raises InputError.
    """
    ready = check_order(order)
    bench = order.bench
    showing = showing_of(bench, order.scenario, ready.bicycle)
    warm = Warmth(bench.thresholds.thermal_time)
    with Screen(screen_name(bench.bus), showing.to_text()) as screen, display:
        for attempt, ridden in _orders(order, attempts):
            record = attempt_file(output, attempt)
            ended = ride_once(
                ridden, ready, screen, record, force=force, say=say, mean_square=warm.left()
            )
            warm.keep(ended.mean_square)
            yield record
            ending = ended.ending
            if not ending.fell or ended.stopped or attempt == attempts:
                return
            say(f"fell     {ending.reason}; the bicycle stands upright again; record {record}")
            which = f"for attempt {attempt + 1} of {attempts}"
            if not _asked(bench, screen, f"{ending.reason}; {ASK}, {which}", say):
                return


class Warmth:
    """What a motor keeps of one attempt for the next (row 13): its mean square torque, falling."""

    def __init__(self, time: float, clock: Callable[[], float] = monotonic) -> None:
        """`time` [s] in which it falls to 1/e."""
        self._time, self._clock = time, clock
        self._mean_square, self._at = 0.0, clock()

    def keep(self, mean_square: float) -> None:
        """As it is now [(N m)²]."""
        self._mean_square, self._at = mean_square, self._clock()

    def left(self) -> float:
        """Of that [(N m)²]."""
        return self._mean_square * math.exp((self._at - self._clock()) / self._time)


def _orders(order: Order, attempts: int) -> Iterator[tuple[int, Order]]:
    """One for each attempt; only the first has a pulse, hands off."""
    yield 1, order
    for attempt in range(2, attempts + 1):
        frames = None if order.frames is None else attempt_file(order.frames, attempt)
        yield attempt, replace(order, pulse=False, frames=frames)


def _asked(bench: BenchSettings, screen: Screen, words: str, say: Say) -> bool:
    """Whether the person wants the next attempt; not where he, or somebody, ends it."""
    try:
        _until_asked(bench, screen, words, say)
    except KeyboardInterrupt:
        say("stopped  interrupted: no more attempts")
        screen.say("interrupted")
        return False
    screen.say("thank you; the drive is being armed, hold the bar straight")
    return True


def _until_asked(bench: BenchSettings, screen: Screen, words: str, say: Say) -> None:
    """Ticks of a disabled drive at zero torque until the person asks. Raises InputError."""
    drive = make_drive(bench.drive)
    asking, silent = Asking(), False
    with on_the_bus(bench, drive, lambda line: None, prove=False) as bus:
        parts = Parts(bench, drive, loop_port(bus, bench, drive), RealTimeClock(bench.period))
        rig = parts.rig
        try:
            rig.begin()
            say(f"waiting  {words} (Ctrl-C: no more)")
            screen.say(words)
            while True:
                time, steer, _ = rig.read()
                seen = rig.observation()
                if seen.bus_trouble:
                    raise InputError(f"fault 20: {seen.bus_trouble}")
                old = seen.age > bench.thresholds.hold_age
                good = not old and seen.pot_ok and seen.gyro_ok and seen.vref_ok
                asked = asking(time, steer, good=good and seen.estop_closed)
                rig.command(0.0)
                if asked:
                    return
                if (seen.age > _SILENT) != silent:
                    silent = not silent
                    said = "the bar's sensor is silent" if silent else words
                    say(f"waiting  {said}")
                    screen.say(said)
                rig.wait()
        finally:
            rig.close()
