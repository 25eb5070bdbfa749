"""The virtual rig: the handlebar of mjcf/rig.xml in MuJoCo, with a rider model's hands on it."""

from functools import lru_cache, partial

import mujoco
import numpy as np

from bikesim.clock import SimulatedClock
from bikesim.errors import InputError
from bikesim.model.haptic import BicycleState
from bikesim.record.channels import Channel
from bikesim.rider.base import Rider
from bikesim.rig.base import RigInfo, Sample
from bikesim.rig.mjcf import rig_model
from bikesim.rig.sensing import Sensor
from bikesim.rig.settings import RigSettings

VIRTUAL_CHANNELS = (
    Channel(
        "rider_torque", "N m", "> 0 turns right", "T_delta of the rider model, without its arms"
    ),
    Channel(
        "motor_torque", "N m", "> 0 turns right", "torque of the motor on the bar, after its lag"
    ),
    Channel("true_steer", "rad", "> 0 turns right", "steer angle without sensor errors"),
    Channel(
        "true_steer_rate", "rad/s", "> 0 turning to the right", "steer rate without sensor errors"
    ),
)


class VirtualRig:
    """A rig in MuJoCo; see `Rig` for its methods.

    `wait` steps the physics at its own finer step, and asks the rider at each of these steps.
    Sensor and motor delay, lag, friction and limits are MuJoCo's; resolution, noise and bias are
    put on what MuJoCo's sensors say, from `random`.
    """

    def __init__(
        self,
        settings: RigSettings,
        rider: Rider,
        *,
        name: str,
        inertia: float,
        steer_axis_tilt: float,
        period: float,
        step: float,
        random: np.random.Generator,
        steer: float = 0.0,
    ) -> None:
        """`inertia` I_δ [kg m²] without arms; `period` [s] a whole number of physics `step` [s].

        The bar rests at `steer` [rad] at first.
        """
        self._substeps = whole_steps(period, step)
        self.info = RigInfo(name, period, inertia, settings.steer_stop, VIRTUAL_CHANNELS)
        make = partial(
            rig_model, settings, inertia=inertia, steer_axis_tilt=steer_axis_tilt, step=step
        )
        # Compiling takes 20 ms; a rider who grips and lets go has two pairs of arms.
        self._model_with = lru_cache(maxsize=4)(make)
        self._arms = rider.arms
        self.model = self._model_with(arms=self._arms)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[0] = steer
        self._rider = rider
        self._clock = SimulatedClock(period)
        self._angle = Sensor.angle(settings, period, random)
        self._rate = Sensor.rate(settings, period, random)
        self._limit = settings.torque_limit
        self._resolution = settings.torque_resolution
        self._seen: BicycleState | None = None
        self._rider_torque = 0.0
        # Views made once: an attribute of MjData costs as much as a tick's arithmetic.
        self._position, self._velocity = self.data.qpos, self.data.qvel
        self._control, self._force = self.data.ctrl, self.data.actuator_force
        self._measured = self.data.sensordata
        mujoco.mj_step1(self.model, self.data)

    def read(self) -> Sample:
        """What the sensors say now."""
        angle, rate = self._measured.tolist()
        return Sample(self._clock.now, self._angle(angle), self._rate(rate))

    def command(self, torque: float) -> float:
        """To the motor, in its counts and within its limit [N m]."""
        if self._resolution:
            torque = self._resolution * round(torque / self._resolution)
        if self._limit is not None:
            torque = min(max(torque, -self._limit), self._limit)
        self._control[0] = torque
        return torque

    def show(self, bicycle: BicycleState) -> None:
        """To the rider's eyes."""
        self._seen = bicycle
        if self._rider.arms is not self._arms:
            self._arms = self._rider.arms
            self.model = self._model_with(arms=self._arms)
            # The step that is half done began with the other arms.
            mujoco.mj_step1(self.model, self.data)

    def telemetry(self) -> tuple[float, ...]:
        """VIRTUAL_CHANNELS; the torques are those of the last physics step."""
        return (
            self._rider_torque,
            self._force.item(0),
            self._position.item(0),
            self._velocity.item(0),
        )

    def wait(self) -> None:
        """One loop period of physics, the rider's torque renewed at each of its steps."""
        seen = self._seen
        assert seen is not None, "a rig shows the bicycle before it waits"
        model, data, control, torque_of = self.model, self.data, self._control, self._rider.torque
        position, velocity = self._position.item, self._velocity.item
        # Begun and ended in the middle of a MuJoCo step, so that at the tick the sensors are those
        # of the state that was reached, not of the one before it.
        control[1] = torque = torque_of(position(0), velocity(0), seen)
        mujoco.mj_step2(model, data)
        for _ in range(self._substeps - 1):
            control[1] = torque = torque_of(position(0), velocity(0), seen)
            mujoco.mj_step(model, data)
        mujoco.mj_step1(model, data)
        self._rider_torque = torque
        self._clock.advance()

    def close(self) -> None:
        """Zero torque."""
        self._control[0] = 0.0


def whole_steps(period: float, step: float) -> int:
    """The physics steps in a loop period [s]. Raises InputError where they are not whole."""
    steps = round(period / step)
    if steps < 1 or abs(steps * step - period) > 1e-9:
        raise InputError(
            f"physics_step = {step} s: the loop period, {period} s, must be a multiple of it"
        )
    return steps
