"""Many virtual rigs at once, stepped by MuJoCo's own batch: one signal of all is one array."""

from collections.abc import Sequence
from functools import partial
from itertools import repeat

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bikesim.clock import SimulatedClock
from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.rider.base import Arms, Rider
from bikesim.rig.base import RigInfo, Sample
from bikesim.rig.mjcf import rig_model
from bikesim.rig.sensing import Sensor
from bikesim.rig.settings import RigSettings
from bikesim.rig.virtual import VIRTUAL_CHANNELS, whole_steps


class Riding:
    """Which rigs of a batch still ride: a mask (n,), and their numbers, None for all of them."""

    def __init__(self, rigs: int) -> None:
        self.mask: NDArray[np.bool_] = np.ones(rigs, dtype=bool)
        self.ids: NDArray[np.intp] | None = None
        self.count = rigs

    def stop(self, which: NDArray[np.bool_]) -> None:
        """Those ride no more."""
        self.mask = self.mask & ~which
        self.ids = np.flatnonzero(self.mask)
        self.count = len(self.ids)


class BatchRig:
    """Rigs of equal settings, each ridden as in a `VirtualRig` of its own, bit for bit; see `Rig`.

    The rider's torque, arms and all signals are arrays (n,), time is one for all. A rig that is
    not `riding` is not stepped any more, and its sensors say zero.
    """

    def __init__(
        self,
        settings: RigSettings,
        rider: Rider,
        riding: Riding,
        *,
        name: str,
        inertia: float,
        steer_axis_tilt: float,
        period: float,
        step: float,
        randoms: Sequence[np.random.Generator],
        steer: Real = 0.0,
        threads: int = 1,
    ) -> None:
        """As for a `VirtualRig`, with a source of noise for each rig; on so many `threads`."""
        self._substeps = whole_steps(period, step)
        self.info = RigInfo(name, period, inertia, settings.steer_stop, VIRTUAL_CHANNELS)
        self._model_with = partial(
            rig_model, settings, inertia=inertia, steer_axis_tilt=steer_axis_tilt, step=step
        )
        self._rider, self._riding, self._rigs = rider, riding, len(randoms)
        self._arms = rider.arms
        models = self._models()
        # Sensors with a past must be read by MuJoCo at every tick; others are the state itself.
        self._late = settings.sensor_delay > 0 or settings.sensor_interval > step
        self.batch = Batch(models[0], self._rigs, threads, persistent=self._late)
        self.batch.set_models(models)
        self._clock = SimulatedClock(period)
        self._angle = Sensor.angle(settings, period, randoms)
        self._rate = Sensor.rate(settings, period, randoms)
        self._limit, self._resolution = settings.torque_limit, settings.torque_resolution
        self._seen: BicycleState | None = None
        self._rider_torque: Real = np.zeros(self._rigs)
        self._position, self._velocity = self.batch.qpos[:, 0], self.batch.qvel[:, 0]
        self._control, self._force = self.batch.ctrl, self.batch.actuator_force
        self._measured = self.batch.sensordata
        self._position[:] = steer
        self.batch.forward(stage=mujoco.mjtStage.mjSTAGE_VEL.value)

    def read(self) -> Sample:
        """What the sensors say now."""
        if self._late:
            angle, rate = self._measured[:, 0].copy(), self._measured[:, 1].copy()
        else:
            angle, rate = self._position.copy(), self._velocity.copy()
        angle, rate = self._angle(angle), self._rate(rate)
        if self._riding.ids is not None:
            angle, rate = (np.where(self._riding.mask, value, 0.0) for value in (angle, rate))
        return Sample(self._clock.now, angle, rate)

    def command(self, torque: Real) -> Real:
        """To the motors, in their counts and within their limit [N m]."""
        if self._resolution:
            torque = self._resolution * (np.rint(torque / self._resolution) + 0.0)
        if self._limit is not None:
            torque = np.minimum(np.maximum(torque, -self._limit), self._limit)
        self._control[:, 0] = torque
        return torque

    def show(self, bicycle: BicycleState) -> None:
        """To the riders' eyes."""
        self._seen = bicycle
        if self._rider.arms is not self._arms:
            self._arms = self._rider.arms
            self.batch.set_models(self._models())
            if self._late:  # else the next step begins afresh anyway
                self.batch.forward(self._riding.ids, stage=_VELOCITY)

    def telemetry(self) -> tuple[Real, ...]:
        """VIRTUAL_CHANNELS, (n,) each; the arrays are good until the next tick."""
        return self._rider_torque, self._force[:, 0], self._position, self._velocity

    def wait(self) -> None:
        """One loop period of physics, the riders' torques renewed at each of its steps."""
        seen = self._seen
        assert seen is not None, "a rig shows the bicycle before it waits"
        step, torque_of, ids = self.batch.step, self._rider.torque, self._riding.ids
        torque = self._rider_torque
        last = self._substeps - 1
        for k in range(self._substeps):
            # Copies: what a rider keeps for later must not change under his hands.
            torque = torque_of(self._position.copy(), self._velocity.copy(), seen)
            self._control[:, 1] = torque
            # At the tick the sensors are those of the state that was reached.
            step(ids, stage=_VELOCITY if self._late and k == last else _NOTHING)
        self._rider_torque = torque
        self._clock.advance()

    def close(self) -> None:
        """Zero torque."""
        self._control[:, 0] = 0.0

    def _models(self) -> list[mujoco.MjModel]:
        each = [value.tolist() if np.ndim(value) else repeat(value) for value in self._arms]
        arms = zip(range(self._rigs), *each, strict=False)
        return [self._model_with(arms=Arms(*one)) for _, *one in arms]


_NOTHING, _VELOCITY = (
    mujoco.mjtStage.mjSTAGE_NONE.value,
    mujoco.mjtStage.mjSTAGE_VEL.value,
)
