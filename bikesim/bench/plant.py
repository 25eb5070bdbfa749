"""What an emulated bench is made of: devices, and a bar in MuJoCo with a rider's hands on it."""

from collections.abc import Callable

import numpy as np

from bikesim.bench.asking import asking_torque
from bikesim.bench.drives import emulated_drive
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.emulated.wheel_node import EmulatedWheelNode
from bikesim.bench.profile import BenchSettings
from bikesim.experiment.run import make_setting, scenario_bicycle, sources
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.torque_record import with_recorded_torque
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.rider.base import Arms, Rider
from bikesim.rider.building import make_rider
from bikesim.rig.virtual import VirtualRig

_OFF = Arms()


class _Hands:
    """A rider who lays his hands on the bar when the ride begins, and not before."""

    def __init__(self, make: Callable[[], Rider]) -> None:
        self._make, self._rider = make, make()
        self.riding = False
        self.asking: float | None = None
        """Since when he asks for another ride with the bar [s]; None: he does not."""

    def rest(self) -> None:
        """The next ride begins as the first: he remembers nothing of this one."""
        if self.riding:
            self.riding, self._rider = False, self._make()

    @property
    def arms(self) -> Arms:
        return self._rider.arms if self.riding else _OFF

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        if self.riding:
            return self._rider.torque(steer, steer_rate, seen)
        return 0.0 if self.asking is None else asking_torque(self.asking, steer, steer_rate)


class Plant:
    """The bench of a profile without its host: the bar turns, the devices know it.

    `quantum` [s] is what `advance` passes; the torque is what the drive gives at its beginning.
    """

    def __init__(self, bench: BenchSettings, scenario: Scenario, *, quantum: float) -> None:
        """`scenario` as `bench_scenario` gives it: rider, seed, physics step, and the bar."""
        bicycle = scenario_bicycle(scenario)
        setting = make_setting(scenario, bicycle, scenario.speed)
        rider = with_recorded_torque(scenario.rider)
        self._hands = _Hands(
            lambda: make_rider(rider, setting, scenario.vision, sources(scenario)[0])
        )
        self._rest = HapticBicycle(bicycle, Law(scenario.law)).start(speed=scenario.speed)
        self.bar = VirtualRig(
            scenario.rig,
            self._hands,
            name="emulated",
            inertia=bench.bar.inertia,
            steer_axis_tilt=bicycle.steer_axis_tilt,
            period=quantum,
            step=min(scenario.physics_step, quantum),
            random=np.random.default_rng(0),
        )
        self._rehearse()
        self._ratio = bench.drive.gear * bench.drive.direction
        self._drive_zero = bench.bar.drive_zero
        self.drive = emulated_drive(bench.drive)
        self.node = EmulatedSteerNode()
        self.wheel = None if bench.wheel is None else EmulatedWheelNode(bench.wheel)
        if self.wheel is not None:
            self.wheel.speed = scenario.speed
        self.largest_torque = 0.0
        """That the drive ever gave, at the steer axis [N m]."""
        self._follow()

    @property
    def devices(self) -> tuple[Device, ...]:
        """All that are on the bus."""
        sensors = (self.node,) if self.wheel is None else (self.node, self.wheel)
        return (*sensors, self.drive)

    @property
    def steer(self) -> float:
        """The bar's true angle [rad]."""
        return self.bar.telemetry()[2]

    @property
    def torque(self) -> float:
        """Of the drive on the bar, now [N m]."""
        return self.drive.torque * self._ratio

    def at_drive(self, torque: float) -> float:
        """A torque at the steer axis as one at the drive's shaft [N m]."""
        return torque / self._ratio

    def show(self, bicycle: BicycleState | None) -> None:
        """To the rider's eyes; None: there is no ride, his hands are off, the bar is straight."""
        if bicycle is not None:
            self._hands.riding, self._hands.asking = True, None
            self.bar.show(bicycle)
            return
        self._hands.rest()
        self.bar.data.qpos[0] = self.bar.data.qvel[0] = 0.0
        self.bar.show(self._rest)

    def ask(self, *, asked: bool) -> None:
        """Whether the rider, between two rides, is to ask for the next one; see `asking`."""
        if not asked:
            self._hands.asking = None
        elif self._hands.asking is None and not self._hands.riding:
            self._hands.asking = 0.0

    def _rehearse(self) -> None:
        """All that the first moment of a ride needs is made now: it must not take longer then."""
        self._hands.riding = True
        self.bar.show(self._rest)
        self._hands.torque(0.0, 0.0, self._rest)
        self._hands.rest()
        self.bar.show(self._rest)

    def advance(self) -> None:
        """One quantum on."""
        torque = self.torque
        self.largest_torque = max(self.largest_torque, abs(torque))
        self.bar.command(torque)
        self.bar.wait()
        if self._hands.asking is not None:
            self._hands.asking += self.bar.info.period
        self._follow()

    def _follow(self) -> None:
        _, _, steer, rate = self.bar.telemetry()
        self.node.steer, self.node.steer_rate = steer, rate
        self.drive.angle = (steer + self._drive_zero) * self._ratio
        self.drive.rate = rate * self._ratio
