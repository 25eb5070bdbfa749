import pytest

from bikesim.errors import InputError
from bikesim.rider.kinds import HUMAN_KEYS, described, identified_run, kind_of, rider_names
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS
from bikesim.rider.settings import RiderSettings

# Those of a script from a file must be told which.
ALONE = [name for name in rider_names() if name not in ("torque-file", "torque-record")]


def test_all_fifteen_identified_riders_have_a_name():
    names = [name for name in rider_names() if name.startswith("schwab2013-")]
    assert [identified_run(name) for name in names] == [run.run for run in IDENTIFIED_RUNS]
    assert len(names) == 15


@pytest.mark.parametrize("name", ALONE)
def test_a_name_alone_has_all_its_figures(name: str):
    settings = RiderSettings(name=name)
    if name == "hands-off":
        assert settings.model_dump(exclude={"name"}, exclude_none=True) == {}
        return
    for figure in ("arm_inertia", "remnant_rms", "tight_stiffness", "grips"):
        assert getattr(settings, figure) is not None


@pytest.mark.parametrize("name", ALONE)
def test_resolved_settings_are_settings(name: str):
    settings = RiderSettings(name=name)
    assert RiderSettings(**settings.model_dump()) == settings
    assert RiderSettings(**settings.model_dump(mode="json", exclude_none=True)) == settings


@pytest.mark.parametrize("name", rider_names())
def test_a_kind_has_keys_of_the_settings(name: str):
    kind = kind_of(name)
    assert set(kind.keys) <= set(RiderSettings.model_fields)
    assert set(kind.figures) <= set(kind.keys)


def test_what_is_human_any_rider_has_but_nobody():
    """The scripted have no senses."""
    for name in rider_names():
        has = [key for key in HUMAN_KEYS if key in kind_of(name).keys]
        if name == "hands-off":
            assert has == []
        elif name.startswith("torque-"):
            assert has == list(HUMAN_KEYS[HUMAN_KEYS.index("muscle_frequency") :])
        else:
            assert has == list(HUMAN_KEYS)


def test_riders_are_listed_with_the_figures_of_their_brains():
    listed = {one.name: one.figures for one in described()}
    assert tuple(listed) == rider_names()
    assert listed["human"] == {"roll_gain": 0.43, "roll_rate_gain": 1.74}
    assert listed["hands-off"] == {}


def test_the_gains_of_an_identified_rider_are_his_runs():
    """SCIENCE.md section 3, run 184."""
    settings = RiderSettings(name="schwab2013-184")
    gains = ("roll_gain", "roll_rate_gain", "steer_integral_gain", "steer_rate_gain")
    assert [getattr(settings, key) for key in gains] == [22.72, 26.12, 65.92, -3.0]


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
        ({"name": "schwab2013-184", "k_phi": 0.2}, "no such figure; it has: roll_gain, roll_rate_"),
        ({"name": "torque-step", "visual_delay": 0.2}, "no such figure; it has: script"),
        ({"name": "torque-step", "script": {"kind": "chirp"}}, "script.kind = 'chirp': of rider"),
        ({"name": "torque-file"}, "rider.script.file: must be given"),
        ({"figures": {"gain": 1.0}}, "rider human has no such figure"),
        ({"name": "my_rider.py"}, "as in my_rider.py:MyRider"),
        ({"name": "a.py:B", "figures": {"gain": "high"}}, "figures.gain = 'high': must be a num"),
        ({"name": "a.py:B", "figures": 3}, "figures = 3: must be a table"),
        ({"vestibular_share": 1.1}, "vestibular_share = 1.1: must be at least 0 and at most 1"),
        ({"torque_limit": 0.0}, "torque_limit = 0.0: must be above 0"),
        ({"grips": [[1.0, "tight"], [0.5, "normal"]]}, "grips: times must rise"),
        ({"grips": [[1.0, "loose"]]}, "must be 'hands-off', 'normal' or 'tight'"),
        ({"grips": [[1.0]]}, "rider.grips.0"),
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


def test_the_delay_is_told_in_steps_of_the_physics(make, seen):
    rider = make("pd", visual_delay=0.2, muscle_frequency=1000.0)
    values = [rider.torque(0.0, 0.0, seen(0.1, 0.0)) for _ in range(401)]
    assert values[399] == 0.0
    assert values[400] > 0.0
