"""An emulated bench in lock-step: no bus, no wall time, the same each time."""

import math
from dataclasses import dataclass, field
from typing import Any

from bikesim.bench.cia402 import NmtCommand
from bikesim.bench.cia402_frames import nmt
from bikesim.bench.cia402_objects import set_up_writes
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drives import make_drive
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.parts import Parts
from bikesim.bench.plant import Plant
from bikesim.bench.preflight import Preflight
from bikesim.bench.profile import BenchSettings
from bikesim.bench.ride import Order, Ride
from bikesim.bench.rig import BENCH_CHANNELS
from bikesim.bench.scenario import bench_scenario
from bikesim.bench.simulated import SimulatedBench
from bikesim.experiment.run import scenario_bicycle
from bikesim.experiment.scenario import Scenario
from bikesim.model.law import Law
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending

NAMES = [channel.name for channel in (*TICK_CHANNELS, *BENCH_CHANNELS)]

CIA402 = {
    "kind": "cia402", "node": 5, "rated_torque": 0.386, "torque_unit": "uNm", "gear": 5.5,
    "encoder_counts": 4096, "torque_limit": 3.5, "velocity_unit": "mrpm",
}  # fmt: skip
ODRIVE = {
    "kind": "odrive", "node": 3, "torque_constant": 0.055, "gear": 4.0, "torque_limit": 3.5,
    "heartbeat_period": 0.01,
}  # fmt: skip
DRIVES = {"cia402": CIA402, "odrive": ODRIVE}


def profile(drive: dict[str, Any] = CIA402, **tables: dict[str, Any]) -> BenchSettings:
    """A bench with the inertia that the law asks for, on no bus that there is."""
    keys = {
        "bus": {"interface": "virtual", "channel": "nobody"},
        "bar": {"inertia": 0.2311},
        "drive": drive,
    }
    given = {**keys, **tables}
    return BenchSettings(**{**given, "bar": {"delay": 0.002, **given["bar"]}})


class Rows(list[tuple[Any, ...]]):
    def append(self, row: tuple[Any, ...]) -> None:
        super().append(row)

    def channel(self, name: str) -> list[float]:
        return [row[NAMES.index(name)] for row in self]


@dataclass
class LockStep:
    """A bench that is set up, disabled; `ride` arms it first."""

    bench: BenchSettings
    scenario: Scenario
    rows: Rows = field(default_factory=Rows)
    real: BenchSettings | None = None
    """What the bench really is; default: what its profile says."""

    def __post_init__(self) -> None:
        self.order = Order(
            "here", self.bench, bench_scenario(self.bench, self.scenario), uncommissioned=True,
            without_margin=2,
        )  # fmt: skip
        real = self.real or self.bench
        scenario = bench_scenario(real, self.scenario)
        self.plant = Plant(real, scenario, quantum=self.bench.period)
        self.sim = SimulatedBench(self.plant, self.bench.period)
        self.drive = make_drive(self.bench.drive)
        if isinstance(self.bench.drive, Cia402Settings):
            assert isinstance(self.plant.drive, EmulatedDrive)
            set_up_at_once(self.plant.drive, self.bench.drive)
        else:
            self.sim.set_up(self.drive)
        self.parts = Parts(self.bench, self.drive, self.sim, self.sim)
        self.guard = None
        self.began = math.inf
        self.answers = True
        self.said = ""
        self.ending = Ending("not ridden")

    def arm(self) -> None:
        self.parts.arm()

    def prepared(self) -> Ride:
        ride = Ride(self.order, self.ready(), self.parts, self.rows)
        self.guard = ride.guard
        return ride

    def ready(self) -> Preflight:
        """Without margins, which take their time."""
        bicycle, law = scenario_bicycle(self.scenario), Law(self.scenario.law)
        return Preflight(self.bench, bicycle, law, 0.2311, None, 0.5, ())

    def ride(self, *, before=lambda: None, interrupted=lambda: False) -> Ending:
        """`before` is called when it is armed."""
        ride = self.prepared()
        self.arm()
        self.parts.rig.hooks = self.parts.rig.hooks._replace(show=self.plant.show)
        self.began = self.sim.now + self.bench.period
        before()
        return ride.go(interrupted)


def set_up_at_once(device: EmulatedDrive, settings: Cia402Settings) -> None:
    """What the set-up over SDO leaves, without its time."""
    device.advance(0.0)
    for write in set_up_writes(settings):
        if (write.index, write.subindex) in device.objects:
            device.objects.set(write.index, write.subindex, write.value)
            device._written(write.index, write.subindex, write.value)
    device.receive(nmt(NmtCommand.START, settings.node), 0.0)


def leaning(**keys: Any) -> Scenario:
    """Hands off, leaning to the right, so that there is a torque."""
    given = {"rider": "hands-off", "speed": 4.0, "duration": 1.3, "start": {"roll_deg": 8.0}}
    return Scenario(**{**given, **keys})
