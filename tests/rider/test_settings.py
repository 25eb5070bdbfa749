import pytest

from bikesim.errors import InputError
from bikesim.rider.building import make_rider
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS
from bikesim.rider.settings import RiderSettings, identified_run, rider_names


def test_all_fifteen_identified_riders_have_a_name():
    names = [name for name in rider_names() if name.startswith("schwab2013-")]
    assert [identified_run(name) for name in names] == [run.run for run in IDENTIFIED_RUNS]
    assert len(names) == 15


@pytest.mark.parametrize("name", rider_names())
def test_a_name_alone_has_all_its_figures(name: str):
    settings = RiderSettings(name=name)
    if name == "hands-off":
        assert settings.model_dump(exclude={"name"}, exclude_none=True) == {}
        return
    for figure in ("muscle_frequency", "arm_inertia", "remnant_rms"):
        assert getattr(settings, figure) is not None


@pytest.mark.parametrize("name", rider_names())
def test_resolved_settings_are_settings(name: str):
    settings = RiderSettings(name=name)
    assert RiderSettings(**settings.model_dump()) == settings


def test_a_figure_beside_the_name_replaces_the_names():
    assert RiderSettings(name="human", roll_gain=3.0).roll_gain == 3.0
    assert RiderSettings(name="human", roll_gain=3.0).visual_delay == 0.2


def test_a_figure_that_is_none_is_not_given():
    assert RiderSettings(name="human", roll_gain=None) == RiderSettings(name="human")


def test_muscles_of_the_identified_riders_are_theirs():
    """[S13]: ω = 2π 2.17 rad/s, ζ = 1/√2."""
    settings = RiderSettings(name="schwab2013-184")
    assert settings.muscle_frequency == pytest.approx(2 * 3.141592653589793 * 2.17)
    assert settings.muscle_damping_ratio == pytest.approx(2**-0.5)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"name": "humann"}, "unknown rider 'humann'; did you mean human?"),
        ({"name": "schwab2013-183"}, "unknown rider 'schwab2013-183'; did you mean schwab2013-18"),
        ({"name": "schwab2013-0184"}, "unknown rider"),
        ({"name": "hands-off", "roll_gain": 1.0}, "hands-off has no such figure"),
        ({"name": "schwab2013-184", "visual_delay": 0.2}, "has no such figure; it has: muscle_"),
        ({"roll_gin": 1.0}, "did you mean roll_gain"),
        ({"visual_delay": -0.1}, "visual_delay = -0.1: must be"),
        ({"muscle_frequency": 0.0}, "muscle_frequency = 0.0: must be"),
        ({"remnant_rms": float("nan")}, "remnant_rms = nan: must be"),
        ({"arm_stiffness": float("inf")}, "arm_stiffness = inf: must be"),
        ({"roll_gain": "much"}, "roll_gain = 'much': must be"),
        ({"name": 3}, "name = 3: must be"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_in_one_line(given: dict, message: str):
    with pytest.raises(InputError) as error:
        RiderSettings(**given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_the_delay_is_told_in_steps_of_the_physics(seen):
    import numpy as np

    settings = RiderSettings(name="pd", visual_delay=0.2, muscle_frequency=1000.0)
    rider = make_rider(settings, 5e-4, np.random.default_rng(1))
    values = [rider.torque(0.0, 0.0, seen(0.1, 0.0)) for _ in range(401)]
    assert values[399] == 0.0
    assert values[400] > 0.0
