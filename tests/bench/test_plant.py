"""A plant that rides in real time: what takes long is done before the ride."""

import pytest

from bikesim.bench.plant import Plant
from bikesim.bench.scenario import bench_scenario
from bikesim.experiment.scenario import Scenario
from bikesim.model.haptic import BicycleState
from bikesim.rig import virtual

from .lockstep import DRIVES, profile

LEANING = BicycleState(*(0.0,) * len(BicycleState._fields))._replace(roll=0.02, speed=3.5)


@pytest.mark.parametrize("kind", DRIVES)
def test_a_ride_begins_and_ends_without_a_model_being_compiled(
    kind: str, monkeypatch: pytest.MonkeyPatch
):
    bench = profile(DRIVES[kind])
    plant = Plant(bench, bench_scenario(bench, Scenario()), quantum=0.001)
    without_hands = plant.bar.model
    monkeypatch.setattr(virtual, "rig_model", pytest.fail)
    for _ in range(2):
        plant.show(LEANING)
        assert plant.bar.model is not without_hands
        for _ in range(300):
            plant.advance()
        assert plant.steer != 0.0
        plant.show(None)
        assert plant.bar.model is without_hands
        assert plant.steer == 0.0


def test_a_second_ride_is_as_the_first():
    bench = profile()
    plant = Plant(bench, bench_scenario(bench, Scenario()), quantum=0.001)
    rides = []
    for _ in range(2):
        plant.show(LEANING)
        steers = []
        for _ in range(400):
            plant.advance()
            steers.append(plant.steer)
        rides.append(steers)
        plant.show(None)
    assert rides[0] == pytest.approx(rides[1], abs=1e-12)
    assert max(map(abs, rides[0])) > 1e-4
