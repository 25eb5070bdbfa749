"""What the loop costs around the physics of many rigs: law, rider, guard, history, metrics.

Target: 1024 rigs in the closed loop, each with the default rider, make at least 80 % of the steps
a second of bare `mujoco.batch` stepping of the same model, both on one thread. Bare is stepped in
three ways: a call for each step, as a rider who acts at each step needs it; a call for the steps
of a tick; a call for 200 steps. The target is of the first: a loop that must answer each step
cannot make fewer calls. The others say what the calls cost. All take turns with the loop every few
ticks, and CPU time is compared, so that what else the machine does matters little.
"""

import statistics
import time
from typing import NamedTuple

import mujoco
from mujoco.batch import Batch

from bikesim.experiment.batch import ride_batch
from bikesim.experiment.metrics import measure
from bikesim.experiment.run import build
from bikesim.experiment.scenario import Scenario
from bikesim.rider.base import Arms
from bikesim.rig.mjcf import rig_model

_RIGS, _ROUNDS, _TURN = 1024, 3, 100  # runs, times, ticks
_SCENARIO = Scenario(duration=2.0)
_SUBSTEPS = round(_SCENARIO.period / _SCENARIO.physics_step)
_STEPS = _SCENARIO.ticks * _SUBSTEPS
_LONG = 200  # steps


class _Bare(NamedTuple):
    """A way to step without a loop: how many steps with each call."""

    what: str
    steps: int


_BARE = (
    _Bare("a call a step (target: 80 %)", 1),
    _Bare(f"a call a tick, of {_SUBSTEPS} steps", _SUBSTEPS),
    _Bare(f"a call for {_LONG} steps", _LONG),
)


def main() -> None:
    """The ratios of each round, and their medians."""
    scenarios = [_SCENARIO.model_copy(update={"seed": seed}) for seed in range(_RIGS)]
    ratios: list[list[float]] = [[] for _ in _BARE]
    for i in range(_ROUNDS):
        turns = _Turns()
        outcomes = ride_batch(scenarios, turns)
        riding = turns.riding()
        began = time.process_time()
        for outcome, scenario in zip(outcomes, scenarios, strict=True):
            measure(outcome.history, scenario)
        measuring = time.process_time() - began
        ours = riding + measuring
        print(
            f"  round {i + 1}: closed loop {_told(ours)} ({measuring / ours:.1%} of it metrics); "
            f"bare {', '.join(_told(bare) for bare in turns.bare)}",
            flush=True,
        )
        for found, bare in zip(ratios, turns.bare, strict=True):
            found.append(bare / ours)
    print(f"  {_RIGS} rigs, one thread, closed loop against bare stepping, median:")
    for (what, _), found in zip(_BARE, ratios, strict=True):
        print(f"    {statistics.median(found):6.1%} of {what}")


class _Turns:
    """Asked at every tick of the closed loop; now and then it steps the bare batches as far."""

    def __init__(self) -> None:
        self.bare = [0.0] * len(_BARE)
        self._batches = [Batch(_model(), _RIGS, 1) for _ in _BARE]
        for batch in self._batches:
            batch.step()
        self._ticks, self._riding = 0, 0.0
        self._since = 0.0

    def __call__(self) -> bool:
        if self._ticks == 0:
            self._since = time.process_time()  # what is made once is not counted
        self._ticks += 1
        if self._ticks % _TURN == 0:
            self._riding += time.process_time() - self._since
            for i, (_, steps) in enumerate(_BARE):
                self.bare[i] += _stepped(self._batches[i], steps)
            self._since = time.process_time()
        return False

    def riding(self) -> float:
        """CPU time of the closed loop so far [s]."""
        return self._riding + time.process_time() - self._since


def _stepped(batch: Batch, steps: int) -> float:
    """CPU time [s] of a turn's steps, so many with each call."""
    began = time.process_time()
    for _ in range(_TURN * _SUBSTEPS // steps):
        batch.step(nstep=steps)
    return time.process_time() - began


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
