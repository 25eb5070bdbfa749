"""What a recorded tick costs, against the least that any loop on the same model must do.

Target: a recorded 60 s run at 1 kHz takes at most 3 times as long a tick as a bare Python loop that
reads the angle and rate, writes the torque and steps the same model.
"""

import statistics
import tempfile
import time
from pathlib import Path

import mujoco

from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario

_ROUNDS = 5
_SCENARIO = Scenario(duration=60)


def main() -> None:
    """Both loops in turn, several times; the ratio of each pair, and its median."""
    ratios = []
    for i in range(_ROUNDS):
        bare, ours = _bare_loop(), _recorded_run()
        ratios.append(ours / bare)
        print(
            f"  round {i + 1}: bare {bare:.2f} µs, recorded run {ours:.2f} µs, {ours / bare:.2f} x"
        )
    print(f"  median {statistics.median(ratios):.2f} x (target: at most 3 x)")


def _recorded_run() -> float:
    """A tick of the default scenario with its record, until the file is closed [µs]."""
    with tempfile.TemporaryDirectory() as folder:
        parts = build(_SCENARIO)
        began = time.perf_counter()
        run(parts, Path(folder) / "run.h5")
        return (time.perf_counter() - began) / _SCENARIO.ticks * 1e6


def _bare_loop() -> float:
    """A tick of the bare loop [µs]: the same model, the same physics steps, a spring for a law."""
    parts = build(_SCENARIO)
    model, data = parts.rig.model, parts.rig.data
    substeps = round(_SCENARIO.period / _SCENARIO.physics_step)
    measured, control = data.sensordata, data.ctrl
    began = time.perf_counter()
    for _ in range(_SCENARIO.ticks):
        angle, rate = measured[0], measured[1]
        control[0] = -2.0 * angle - 0.5 * rate
        for _ in range(substeps):
            mujoco.mj_step(model, data)
    return (time.perf_counter() - began) / _SCENARIO.ticks * 1e6


if __name__ == "__main__":
    main()
