from pathlib import Path

from bikesim import bicycles
from bikesim.bench.recorded import torque_on_the_wire
from bikesim.record.recording import read_recording


def test_the_torque_on_the_wire_is_that_which_a_real_rig_commanded(shared: Path):
    """phobos, TU Delft 2017: its steer as sensor frames; its gravity is 9.80665."""
    recording = read_recording(shared / "recordings" / "phobos_5mps.csv.gz")
    found = torque_on_the_wire(recording, bicycles.load("benchmark").with_gravity(9.80665), 2.0)
    assert found.ticks == 2000
    assert found.largest > 0.3
    assert found.error <= 0.05
