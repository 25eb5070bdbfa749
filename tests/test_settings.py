import math
from typing import Any, ClassVar

import pytest

from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario
from bikesim.guard import GuardSettings
from bikesim.rider.settings import RiderSettings
from bikesim.rig.settings import RigSettings

# What a user may get wrong, and what the line must name: the key, its value or the near names.
WRONG = [
    ({"speeed": 3.0}, ["'speeed'", "speed"]),
    ({"speed": "fast"}, ["speed = 'fast'"]),
    ({"speed": -1.0}, ["speed = -1.0", "0", "30"]),
    ({"speed": math.nan}, ["speed = nan", "finite"]),
    ({"duration": math.inf}, ["duration = inf"]),
    ({"duration": 1e-5}, ["duration = 1e-05", "0.001"]),
    ({"law": "papr"}, ["law = 'papr'", "paper", "momentum", "off"]),
    ({"seed": -1}, ["seed = -1"]),
    ({"seed": 1.5}, ["seed = 1.5"]),
    ({"period": 0.0}, ["period = 0.0"]),
    ({"speed_profile": [[1, 2], [0, 3]]}, ["speed_profile", "rise"]),
    ({"speed_profile": [[1, 2, 3]]}, ["speed_profile"]),
    ({"rig": {"angle_nois": 1.0}}, ["[rig]", "'angle_nois'", "angle_noise"]),
    ({"rig": {"angle_noise": -1.0}}, ["rig.angle_noise = -1.0"]),
    ({"rig": 3}, ["rig = 3"]),
    ({"rider": {"name": "human", "roll_gain": 1e9}}, ["rider.roll_gain = 1000000000.0"]),
    ({"rider": "humann"}, ["'humann'", "human"]),
    ({"guard": {"torque_limit": 0.0}}, ["guard.torque_limit = 0.0"]),
    ({"guard": {"fall_rol_deg": 30.0}}, ["[guard]", "fall_roll_deg"]),
    ({"start": {"roll_deg": 90.0}}, ["start.roll_deg = 90.0"]),
    ({"pushes": [{"time": 1.0}]}, ["pushes", "impulse"]),
    ({"pushes": [{"time": 1.0, "impulse": 1.0, "durration": 1.0}]}, ["'durration'", "duration"]),
    ({"pushes": 3}, ["pushes = 3"]),
]


@pytest.mark.parametrize(("given", "named"), WRONG, ids=str)
def test_what_cannot_be_is_refused_in_one_line_that_names_it(given: dict, named: list[str]):
    with pytest.raises(InputError) as error:
        Scenario(**given)
    message = str(error.value)
    assert "\n" not in message
    assert len(message) < 400
    assert [part for part in named if part not in message] == []


def test_settings_are_frozen():
    with pytest.raises(Exception, match="frozen"):
        setattr(GuardSettings(), "torque_limit", 1e9)  # noqa: B010  (pyright knows it is frozen)


@pytest.mark.parametrize("kind", [Scenario, GuardSettings, RiderSettings, RigSettings])
def test_all_have_defaults(kind: type):
    assert kind() == kind()


class TestScenario:
    everything: ClassVar = {
        "bicycle": "davis",
        "speed": 3.19,
        "law": "momentum",
        "rider": "schwab2013-184",
        "rig": "phobos",
        "speed_profile": [[0.0, 2.0], [5.0, 4.0]],
        "pushes": [{"time": 1.0, "impulse": 2.0}],
        "seed": 2**62,
    }

    @pytest.mark.parametrize(
        "given", [{}, {"rider": "hands-off"}, {"rider": {"name": "pd"}}, everything], ids=str
    )
    def test_its_dump_makes_it_again(self, given: dict):
        scenario = Scenario(**given)
        assert Scenario(**scenario.model_dump()) == scenario

    @pytest.mark.parametrize(("key", "name"), [("rider", "pd"), ("rig", "phobos")])
    def test_a_name_is_short_for_a_table_with_that_name(self, key: str, name: str):
        short: dict[str, Any] = {key: name}
        table: dict[str, Any] = {key: {"name": name}}
        assert Scenario(**short) == Scenario(**table)

    @pytest.mark.parametrize(
        ("duration", "period", "ticks"), [(30, 1e-3, 30_000), (0.001, 1e-3, 1), (1.0, 0.003, 333)]
    )
    def test_its_ticks_are_those_of_its_duration(self, duration: float, period: float, ticks: int):
        assert Scenario(duration=duration, period=period).ticks == ticks
