"""Ride after ride on a bench: a bicycle that fell stands upright again (row 23).

A fall has ended the ride: the torque ramped out, the drive disabled, the record closed. What comes
next is a ride like the first, with a record of its own, everything checked and the drive armed
anew; and only once whoever holds the bar has asked for it, with the bar.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path

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
) -> list[Path]:
    """Arm, ramp in, ride, ramp out, disable; recorded in `output`. Gives the records.

    After a fall again, up to `attempts` in all, see `attempt_file`. Ctrl-C while it waits for the
    next one ends it. `display` is entered when there is something to look at, before anything is on
    the bus. Raises InputError.
    """
    ready = check_order(order)
    bench = order.bench
    showing = showing_of(bench, order.scenario, ready.bicycle)
    records: list[Path] = []
    with Screen(screen_name(bench.bus), showing.to_text()) as screen, display:
        for attempt, ridden in _orders(order, attempts):
            if attempt > 1:
                words = f"{ASK}, for attempt {attempt} of {attempts}"
                say(f"waiting  {words} (Ctrl-C: no more)")
                screen.say(words)
                try:
                    _until_asked(bench)
                except KeyboardInterrupt:
                    screen.say("interrupted")
                    break
            record = attempt_file(output, attempt)
            records.append(record)
            ending = ride_once(ridden, ready, screen, record, force=force, say=say)
            if not ending.fell:
                break
            screen.stand(ending.reason)
            say(f"fell     {ending.reason}; the bicycle stands upright again; record {record}")
    return records


def _orders(order: Order, attempts: int) -> Iterator[tuple[int, Order]]:
    """One for each attempt; only the first has a pulse, hands off."""
    yield 1, order
    for attempt in range(2, attempts + 1):
        frames = None if order.frames is None else attempt_file(order.frames, attempt)
        yield attempt, replace(order, pulse=False, frames=frames)


def _until_asked(bench: BenchSettings) -> None:
    """Ticks of a disabled drive at zero torque until the person asks. Raises InputError."""
    drive = make_drive(bench.drive)
    asking = Asking()
    with on_the_bus(bench, drive, lambda line: None, prove=False) as bus:
        parts = Parts(bench, drive, loop_port(bus, bench, drive), RealTimeClock(bench.period))
        rig = parts.rig
        try:
            rig.begin()
            while True:
                time, steer, steer_rate = rig.read()
                if trouble := rig.trouble:
                    raise InputError(f"fault 20: {trouble}")
                seen = rig.observation()
                asked = seen.age <= bench.thresholds.hold_age and asking(time, steer, steer_rate)
                rig.command(0.0)
                if asked:
                    return
                rig.wait()
        finally:
            rig.close()
