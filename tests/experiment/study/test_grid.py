"""Factors, levels and conditions as a file says them."""

from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.plan import TooManyError
from bikesim.rider.settings import RiderSettings

HEAD = "seeds = 2\n"


def refusal(make, text: str) -> str:
    with pytest.raises(InputError) as raised:
        make(text)
    message = str(raised.value)
    assert "\n" not in message
    return message


class TestGrid:
    def test_the_last_factor_changes_fastest(self, small):
        assert [condition.values for condition in small.conditions] == [
            ("paper", 0.1), ("paper", 0.2), ("off", 0.1), ("off", 0.2),
        ]  # fmt: skip
        assert [condition.number for condition in small.conditions] == [1, 2, 3, 4]
        assert small.conditions[1].name == "law=paper, visual_delay=0.2"
        assert small.runs == 12

    def test_a_condition_is_the_scenario_with_its_levels(self, small):
        rider = RiderSettings(name="human", visual_delay=0.1)
        expected = Scenario(duration=0.2, law="off", rider=rider)
        assert small.conditions[2].scenario == expected

    def test_without_factors_there_is_one_condition(self, make):
        study = make(f"{HEAD}scenario = {{ speed = 4.0 }}")
        assert [condition.name for condition in study.conditions] == ["base"]
        assert study.conditions[0].scenario == Scenario(speed=4.0)

    def test_a_factor_may_have_a_name_of_its_own(self, make):
        study = make(f"{HEAD}factors.delay = {{ key = 'rider.visual_delay', values = [0.3] }}")
        assert study.factors[0].name == "delay"
        assert study.conditions[0].scenario.rider.visual_delay == 0.3

    def test_keys_that_end_alike_are_told_apart(self, make):
        study = make(f"{HEAD}[factors]\n'rig.torque_limit' = [3]\n'guard.torque_limit' = [9]")
        assert study.conditions[0].name == "rig.torque_limit=3, guard.torque_limit=9"

    def test_a_whole_rider_is_set_before_what_is_set_of_him(self, make):
        study = make(f"{HEAD}[factors]\n'rider.visual_delay' = [0.3]\nrider = ['pd', 'human']")
        riders = [condition.scenario.rider for condition in study.conditions]
        assert [(rider.name, rider.visual_delay) for rider in riders] == [
            ("pd", 0.3), ("human", 0.3),
        ]  # fmt: skip

    def test_values_of_several_kinds_are_text_in_the_table(self, make):
        study = make(f"{HEAD}[factors]\npushes = [[], [{{ time = 1, impulse = 5 }}]]")
        assert [level.value for level in study.factors[0].levels] == [
            "[]", '[{"time":1,"impulse":5}]',
        ]  # fmt: skip
        assert study.conditions[1].scenario.pushes[0].impulse == 5


class TestNamedLevels:
    TEXT = f"""{HEAD}
        [scenario]
        rider = {{ name = "human", visual_delay = 0.15 }}
        [factors.arms.usual]
        [factors.arms.stiff]
        rider.arm_stiffness = 40.0
        "rider.arm_damping" = 6.0
    """

    def test_set_several_keys_dotted_or_not(self, make):
        usual, stiff = (condition.scenario.rider for condition in make(self.TEXT).conditions)
        assert (stiff.arm_stiffness, stiff.arm_damping) == (40, 6)
        assert (usual.arm_stiffness, usual.arm_damping) == (5, 2)
        assert (stiff.visual_delay, usual.visual_delay) == (0.15, 0.15)

    def test_an_extra_condition_has_the_level_that_it_comes_to(self, make):
        extra = '\n[[conditions]]\nname = "mine"\nset = { rider.arm_stiffness = 40.0, '
        study = make(self.TEXT + extra + "rider.arm_damping = 6.0, speed = 4.0 }")
        assert study.conditions[-1].values == ("stiff",)
        assert study.conditions[-1].scenario.speed == 4
        assert study.runs == 6

    def test_an_extra_condition_that_has_none_has_a_gap(self, make):
        text = f"{HEAD}factors.law = ['paper']\n[[conditions]]\nname = 'off'\nset.law = 'off'"
        assert [condition.values for condition in make(text).conditions] == [("paper",), (None,)]


class TestFiles:
    def test_are_found_beside_the_experiment(self, make, tmp_path: Path):
        (tmp_path / "track.csv").write_text("x,y\n" + "".join(f"{5 * i},0\n" for i in range(9)))
        study = make(f"{HEAD}[factors]\npath = ['straight', 'track.csv']")
        assert [level.value for level in study.factors[0].levels] == ["straight", "track.csv"]
        assert len(study.conditions[1].scenario.path.points) == 9

    def test_a_base_scenario_is_part_of_it(self, make, tmp_path: Path):
        (tmp_path / "ride.toml").write_text("seed = 7\nspeed = 4.0\nrider = 'pd'\n")
        study = make(f"{HEAD}base = 'ride.toml'\n[scenario]\nrider.visual_delay = 0.1")
        scenario = study.conditions[0].scenario
        assert (scenario.speed, scenario.rider.name, scenario.rider.visual_delay) == (4, "pd", 0.1)


class TestRefused:
    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "seeds: must be given"),
            ("seeds = 0", "seeds: there are none, so the experiment has 0 runs"),
            ("seeds = []", "seeds: there are none, so the experiment has 0 runs"),
            ("seeds = [3, 4, 3]", "seeds: 3 is there twice"),
            ("seeds = -1", "seeds: there are none"),
            ("seeds = 1.5", "seeds: must be how many"),
            ("seeds = true", "seeds: must be how many"),
            (f"{HEAD}sceanrio = {{}}", "unknown key 'sceanrio'; did you mean scenario"),
            (f"{HEAD}keep = 'some'", "keep = 'some': must be 'none', 'first', 'falls' or 'all'"),
            (f"{HEAD}scenario.seed = 3", "scenario.seed: an experiment has seeds"),
            (f"{HEAD}scenario.speed = 99", "condition 'base': speed = 99: must be at least 0"),
            (f"{HEAD}factors.law = []", "factors.law: has no level, so the experiment has 0 runs"),
            (f"{HEAD}factors.law = ['off', 'off']", "factors.law: 'off' is there twice"),
            (f"{HEAD}factors.law = 'off'", "factors.law = 'off': must be a list of values"),
            (f"{HEAD}factors.seed = [1]", "factors.seed: the results have a column"),
            (f"{HEAD}factors.duration = [1]", "factors.duration: the results have a column"),
            (
                f"{HEAD}factors.law = ['paper', 'magic']",
                "factors.law, level magic: law = 'magic': must be 'paper', 'momentum' or 'off'",
            ),
            (
                f"{HEAD}[factors]\n'rider.visual_delay' = [0.1, 9]\nspeed = [3, 4]",
                "factors.rider.visual_delay, level 9: rider.visual_delay = 9: must be at least 0 "
                "and at most 5",
            ),
            (
                f"{HEAD}[factors]\nrider.visual_delay = [0.1]",
                "factors.rider.visual_delay: write the key of a scenario in quotes: "
                '"rider.visual_delay" = [...]',
            ),
            (
                f"{HEAD}[factors]\n'rider.visual_delay' = [0.1]\nrider = ['human', 'hands-off']",
                "condition 'visual_delay=0.1, rider=hands-off': rider.visual_delay = 0.1: rider "
                "hands-off has no such figure",
            ),
            (
                f"{HEAD}[factors]\nspeed = [3]\nv = {{ key = 'speed', values = [4] }}",
                "factors speed and v both set speed",
            ),
            (f"{HEAD}[factors.a]\nb = 1", "factors.a.b = 1: must be a table of keys"),
            (f"{HEAD}[[conditions]]\nset = {{}}", "conditions.name: must be given"),
            (
                f"{HEAD}factors.law = ['off']\n[[conditions]]\nname = 'law=off'\nset = {{}}",
                "conditions: 'law=off' is there twice",
            ),
            (f"{HEAD}base = 3", "base = 3: must be the name of a scenario file"),
            (f"{HEAD}report.metrics = ['roll']", "report.metrics: unknown metric 'roll'; did you"),
            (
                f"{HEAD}[[report.contrasts]]\nfactor = 'law'\nlevels = ['paper', 'off']",
                "report.contrasts: no factor 'law'; there are: none",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n"
                "[[report.contrasts]]\nfactor = 'law'\nlevels = ['paper', 'off']",
                "report.contrasts: law has no level 'off'; it has: paper",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n"
                "[[report.contrasts]]\nfactor = 'law'\nlevels = ['paper']",
                "report.contrasts.levels = ['paper']: must be a list of 2",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n[[report.contrasts]]\nof = 'law=paper'",
                "report.contrasts: must be given: factor and levels, or of and against",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n[[report.contrasts]]\nof = 'law=paper'\n"
                "against = 'law=off'\nfactor = 'law'",
                "report.contrasts: must be given: factor and levels, or of and against",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n"
                "[[report.contrasts]]\nof = 'law=off'\nagainst = 'law=paper'",
                "report.contrasts.of: unknown condition 'law=off'; did you mean law=paper?",
            ),
            (
                f"{HEAD}factors.law = ['paper']\n"
                "[[report.contrasts]]\nof = 'law=paper'\nagainst = 'law=paper'",
                "report.contrasts: 'law=paper': two different conditions, please",
            ),
        ],
    )
    def test_in_one_line_that_says_what_and_where(self, make, text: str, message: str):
        assert refusal(make, text).startswith(message)

    def test_of_a_great_many_conditions_a_line_names_some(self, make):
        speeds = [k / 10 for k in range(99)]
        text = f"{HEAD}factors.speed = {speeds}\n[[report.contrasts]]\nof = 'x'\nagainst = 'y'"
        said = refusal(make, text)
        assert said.startswith("report.contrasts.of: unknown condition 'x'; known: speed=0, speed=")
        assert said.endswith("speed=5.9, and 39 more")

    def test_more_runs_than_allowed_are_counted_not_made(self, make):
        text = "seeds = 1000000\nfactors.speed = [3, 4]\n"
        with pytest.raises(TooManyError, match="2000000 runs: more than max_runs = 1000000"):
            make(text)
