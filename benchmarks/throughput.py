"""What the loop costs around the physics of many rigs: law, rider, guard, history, metrics.

Target: 1024 rigs in the closed loop, each with the default rider, make at least 80 % of the steps
a second of bare `mujoco.batch` stepping of the same model, both on one thread. The two take turns
every few ticks, and CPU time is compared, so that what else the machine does matters little.
"""

import statistics
import time

import mujoco
from mujoco.batch import Batch

from bikesim.experiment.batch import ride_batch
from bikesim.experiment.metrics import measure
from bikesim.experiment.run import build
from bikesim.experiment.scenario import Scenario
from bikesim.rider.base import Arms
from bikesim.rig.mjcf import rig_model

_RIGS, _ROUNDS, _TURN = 1024, 3, 50
_SCENARIO = Scenario(duration=4.0)
_SUBSTEPS = round(_SCENARIO.period / _SCENARIO.physics_step)
_STEPS = _SCENARIO.ticks * _SUBSTEPS


def main() -> None:
    """The ratio of each round, and its median."""
    scenarios = [_SCENARIO.model_copy(update={"seed": seed}) for seed in range(_RIGS)]
    ratios = []
    for i in range(_ROUNDS):
        turns = _Turns()
        outcomes = ride_batch(scenarios, turns)
        riding, bare = turns.riding(), turns.bare
        began = time.process_time()
        for outcome, scenario in zip(outcomes, scenarios, strict=True):
            measure(outcome.history, scenario)
        measuring = time.process_time() - began
        ours = riding + measuring
        ratios.append(bare / ours)
        print(
            f"  round {i + 1}: bare {_told(bare)}, closed loop {_told(ours)} "
            f"({measuring / ours:.1%} of it metrics): {bare / ours:.1%}",
            flush=True,
        )
    print(f"  {_RIGS} rigs, one thread: median {statistics.median(ratios):.1%} (target: 80 %)")


class _Turns:
    """Asked at every tick of the closed loop; now and then it steps the bare batch as far."""

    def __init__(self) -> None:
        self.bare = 0.0
        self._batch = Batch(_model(), _RIGS, 1)
        self._batch.step()
        self._ticks, self._riding = 0, 0.0
        self._since = 0.0

    def __call__(self) -> bool:
        if self._ticks == 0:
            self._since = time.process_time()  # what is made once is not counted
        self._ticks += 1
        if self._ticks % _TURN == 0:
            began = time.process_time()
            for _ in range(_TURN * _SUBSTEPS):
                self._batch.step()  # a call a step, as the rider needs it
            ended = time.process_time()
            self._riding += began - self._since
            self.bare += ended - began
            self._since = ended
        return False

    def riding(self) -> float:
        """CPU time of the closed loop so far [s]."""
        return self._riding + time.process_time() - self._since


def _model() -> mujoco.MjModel:
    """What a batch of the scenario steps."""
    parts, rider = build(_SCENARIO), _SCENARIO.rider
    figures = rider.arm_inertia, rider.arm_damping, rider.arm_stiffness
    return rig_model(
        _SCENARIO.rig,
        inertia=parts.rig.info.inertia,
        arms=Arms(*(figure or 0.0 for figure in figures)),
        steer_axis_tilt=parts.bicycle.steer_axis_tilt,
        step=_SCENARIO.physics_step,
        drawn=False,
    )


def _told(seconds: float) -> str:
    return f"{_STEPS * _RIGS / seconds / 1e6:.2f} M steps/s"


if __name__ == "__main__":
    main()
