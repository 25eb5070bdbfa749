"""A bench whose bar moves as a recording says: what does our host put on the wire for it?"""

import math
from typing import NamedTuple

import numpy as np

from bikesim.bench.cia402_frames import CobIds
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drives import make_drive
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.faults import Thresholds
from bikesim.bench.guard import CEILING
from bikesim.bench.parts import Parts
from bikesim.bench.preflight import Preflight
from bikesim.bench.profile import BenchSettings
from bikesim.bench.ride import Order, Ride
from bikesim.bench.scenario import bench_scenario
from bikesim.bench.simulated import SimulatedBench
from bikesim.experiment.scenario import Scenario, StartSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState
from bikesim.model.law import Law
from bikesim.record.recording import Recording


class WireError(NamedTuple):
    """Torque in the drive's frames against that recorded [N m]: largest error, and torque."""

    error: float
    largest: float
    ticks: int


class _RecordedBar:
    """Sensor node and drive on a bar that nothing but the recording moves."""

    def __init__(self, recording: Recording, drive: Cia402Settings) -> None:
        self._steer, self._rate = recording.steer.tolist(), recording.steer_rate.tolist()
        self._row = 0
        self.node = EmulatedSteerNode()
        self.drive = EmulatedDrive(drive.node, Motor.of_profile(drive))

    @property
    def devices(self) -> tuple[Device, ...]:
        return self.node, self.drive

    def show(self, bicycle: BicycleState) -> None:
        """A tick is done: on to the next row."""
        del bicycle
        self._row += 1

    def advance(self) -> None:
        row = min(self._row, len(self._steer) - 1)
        self.node.steer, self.node.steer_rate = self._steer[row], self._rate[row]


def torque_on_the_wire(recording: Recording, bicycle: Bicycle, seconds: float) -> WireError:
    """Its first seconds, at 1 kHz, as frames of the sensor node; roll and rate begin as recorded.

    The guard lets out up to 10 N m, without ramping in.
    """
    bench = _wide()
    assert isinstance(bench.drive, Cia402Settings)
    start = StartSettings(
        roll_deg=math.degrees(recording.roll[0]),
        roll_rate_deg_s=math.degrees(recording.roll_rate[0]),
    )
    scenario = Scenario(
        speed=float(recording.speed[0]), start=start, duration=seconds, bicycle="benchmark"
    )
    order = Order("recorded", bench, bench_scenario(bench, scenario))
    bar = _RecordedBar(recording, bench.drive)
    sim = SimulatedBench(bar, bench.period)
    drive = make_drive(bench.drive)
    sim.set_up(drive)
    parts = Parts(bench, drive, sim, sim)
    ready = Preflight(bench, bicycle, Law.PAPER, bench.bar.inertia, None, 0.0, ())
    ride = Ride(order, ready, parts, _Nobody())
    parts.arm()
    parts.rig.hooks = parts.rig.hooks._replace(show=bar.show)
    before = len(sim.sent)
    ride.go()
    command, scale = CobIds.of_node(bench.drive.node).command, bench.drive.scale
    sent = [
        scale.torque(int.from_bytes(frame.data[2:4], "little", signed=True))
        for _, frame in sim.sent[before:]
        if frame.id == command
    ]
    # One frame before the first tick: arming ends with a tick of its own.
    ticks = round(seconds / bench.period)
    ours, theirs = np.array(sent[:ticks]), recording.torque[:ticks]
    return WireError(float(np.abs(ours - theirs).max()), float(np.abs(theirs).max()), len(ours))


class _Nobody:
    def append(self, row: tuple) -> None:
        """Nobody keeps it."""


_WIDE = {
    "ramp_in": 1e-6, "follow_error": 100.0, "slip_rate": 100.0, "bias_angle": 100.0,
    "fall_roll_deg": 89.0,
}  # fmt: skip


def _wide() -> BenchSettings:
    """A drive that can give what most recorded rigs gave, and thresholds that let it.

    No profile may have such ones; here nobody holds the bar.
    """
    thresholds = Thresholds().model_copy(update=_WIDE)
    keys = {
        "bus": {"interface": "virtual", "channel": "recorded"},
        "bar": {"inertia": 0.0427, "delay": 0.0},
        "limits": {"torque": CEILING, "torque_rate": 1e5, "continuous_torque": CEILING},
        "thresholds": thresholds,
        "drive": {
            "kind": "cia402", "node": 5, "rated_torque": 2.0, "torque_unit": "mNm", "gear": 5.0,
            "encoder_counts": 4096, "torque_limit": CEILING,
        },
    }  # fmt: skip
    return BenchSettings(**keys)
