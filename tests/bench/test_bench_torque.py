"""The torque of who holds the bar of a bench, which its record does not have: from the bar."""

from pathlib import Path

import numpy as np
import pytest

from bikesim.bench.rig import BENCH_CHANNELS
from bikesim.bench.scenario import header_text
from bikesim.experiment.run import scenario_bicycle
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.torque_record import with_recorded_torque
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import RunHeader
from bikesim.record.provenance import Provenance
from bikesim.record.reader import open_run
from bikesim.record.writer import RunWriter
from bikesim.rider.script_settings import ScriptSettings
from bikesim.rider.settings import RiderSettings

from .lockstep import LockStep, profile


@pytest.fixture(scope="module")
def ridden(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, np.ndarray]:
    """A record of 3 s, and the times [s] and torques [N m] of the emulated rider, (n, 2)."""
    script = ScriptSettings(kind="multisine", torque_rms=0.5, highest=12.0, lines=8)
    rider = RiderSettings(name="torque-multisine", script=script)
    bench = LockStep(profile(), Scenario(rider=rider, speed=5.0, duration=3.0))
    hands, given = bench.plant._hands, []
    intended = hands.torque

    def torque(*seen) -> float:
        answer = intended(*seen)
        if bench.sim.now >= bench.began:
            given.append((bench.sim.now - bench.began, answer))
        return answer

    hands.torque = torque  # type: ignore[method-assign]
    ending = bench.ride()
    path = tmp_path_factory.mktemp("bench") / "ride.h5"
    header = RunHeader(
        scenario=header_text(bench.order.bench, bench.order.scenario),
        bicycle=scenario_bicycle(bench.scenario), law="paper", handlebar_inertia=0.2311,
        rig="bench", rider="person", seed=1, provenance=Provenance.gather(),
    )  # fmt: skip
    with RunWriter(
        path, channels=(*TICK_CHANNELS, *BENCH_CHANNELS), period=1e-3, planned_ticks=4000,
        header=header,
    ) as writer:  # fmt: skip
        for row in bench.rows:
            writer.append(row)
        writer.finish(ending)
    return path, np.array(given)


def test_it_is_what_the_emulated_rider_gave(ridden: tuple[Path, np.ndarray]):
    """Within 2 %, and at its time: 5 ms off would be 3 %."""
    path, given = ridden
    assert "rider_torque" not in open_run(path).names
    script = ScriptSettings(kind="record", file=str(path))
    found = with_recorded_torque(RiderSettings(name="torque-record", script=script)).script
    assert found is not None
    time, torque = np.array(found.samples)[10:-10].T
    block = np.linspace(-0.01, 0.01, 41)
    expected = np.interp(time[:, None] + block, *given.T).mean(axis=1)
    assert np.std(expected) > 0.3
    assert np.std(torque - expected) < 0.02 * np.std(expected)
