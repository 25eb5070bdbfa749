"""The parts of a bench, and the bus that they are on: for what rides, checks and measures."""

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from bikesim.bench.arm import arm, listen
from bikesim.bench.bus import BusPort, close_bus, filter_for, open_bus
from bikesim.bench.calibration_check import NOT_CHECKED, check_calibration, link_to_node
from bikesim.bench.drive import Drive
from bikesim.bench.profile import BenchSettings
from bikesim.bench.pulse import send_pulse
from bikesim.bench.rig import BENCH_CHANNELS, BenchRig, Clock, Port
from bikesim.bench.senses import Bar, DriveBar, NodeBar
from bikesim.bench.wheel_course import Wheel
from bikesim.rig.base import RigInfo

if TYPE_CHECKING:
    import can

Say = Callable[[str], object]


class Parts:
    """The parts of a bench, on a port: what arms, measures and rides uses them."""

    def __init__(self, bench: BenchSettings, drive: Drive, port: Port, clock: Clock) -> None:
        self.bench, self.drive = bench, drive
        self.bar = make_bar(bench, drive)
        self.wheel = None if bench.wheel is None else Wheel(bench.wheel)
        self.rig = BenchRig(
            RigInfo(
                "bench",
                bench.period,
                bench.bar.inertia,
                math.radians(bench.bar.steer_stop_deg),
                BENCH_CHANNELS,
            ),
            port,
            self.bar,
            drive,
            clock=clock,
            late=bench.thresholds.late,
            others=() if self.wheel is None else (self.wheel,),
        )

    def arm(self) -> None:
        """See `arm.arm`."""
        arm(self.rig, self.bench.thresholds, self.drive.heartbeat_period)

    def pulse(self) -> str:
        """See `pulse.send_pulse`; a line for a person."""
        bench = self.bench
        found = send_pulse(
            self.rig, bench.bar, bench.limits, bench.thresholds, self.drive.heartbeat_period
        )
        return (
            f"pulse    inertia {found.inertia:.4g} kg m² (profile {bench.bar.inertia:.4g}), torque "
            f"measured {100 * found.torque_ratio:.0f} % of that commanded"
        )


def make_bar(bench: BenchSettings, drive: Drive) -> Bar:
    """Where steer angle and rate come from."""
    return NodeBar() if bench.bar.source == "node" else DriveBar(drive, bench.bar.drive_zero)


@contextmanager
def on_the_bus(
    bench: BenchSettings,
    drive: Drive,
    say: Say = print,
    *,
    prove: bool = True,
    plan: Iterable[str] = (),
) -> Iterator:
    """The profile's bus with the drive on it set up, disabled, its watchdog proven (see `Drive`).

    `plan`: lines that are said once everybody is there, and before the drive is touched.
    Whoever is asked for is there and nobody else commands the drive; the sensor node has the
    calibration of the profile. Raises InputError.
    """
    bar = make_bar(bench, drive)
    wheel = () if bench.wheel is None else (Wheel(bench.wheel),)
    bus = open_bus(bench.bus)
    try:
        listen(bus, drive, bar, wheel, enabling=prove)
        if bench.bar.source == "node":
            _check_node(bus, bench, say)
        for line in plan:
            say(line)
        filter_for(bus, drive.ids)
        for line in drive.set_up(bus, prove=prove):
            say(f"drive    {line}")
        filter_for(bus, None)
        yield bus
    finally:
        close_bus(bus)


def _check_node(bus: "can.BusABC", bench: BenchSettings, say: Say) -> None:
    wanted = bench.bar.calibration
    if wanted is None:
        say(f"node     {NOT_CHECKED}")
        return
    check_calibration(link_to_node(bus), wanted)


def loop_port(
    bus: "can.BusABC",
    bench: BenchSettings,
    drive: Drive,
    log: "Callable[[can.Message, float | None], object] | None" = None,
) -> BusPort:
    """Takes what the loop needs of all that is on the bus, and a second master's frames."""
    wheel = frozenset[int]() if bench.wheel is None else Wheel(bench.wheel).ids
    ids = make_bar(bench, drive).ids | drive.ids | wheel | drive.host_ids
    return BusPort(bus, ids, log, drive.host_ids if bench.bus.echoes else ())
