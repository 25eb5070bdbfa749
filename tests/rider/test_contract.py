"""What every rider does, whatever his name; and that the check of it finds who does not."""

from pathlib import Path

import numpy as np
import pytest

from bikesim.path.building import make_path
from bikesim.path.settings import PathSettings
from bikesim.rider.base import Arms
from bikesim.rider.contract import Finding, check
from bikesim.rider.kinds import rider_names
from bikesim.rider.settings import RiderSettings

# One of the identified is as good as all.
NAMES = ("human", "pd", "hands-off", "schwab2013-184", "hess2012", "lqr", "torque-multisine")
SLALOM = make_path(PathSettings(kind="slalom", start=2.0))


@pytest.fixture
def checked(setting):
    def check_one(name: str, **figures) -> list[Finding]:
        where = setting(path=SLALOM, speed=5.0, step=2e-3)
        return check(RiderSettings(name=name, **figures), where)

    return check_one


@pytest.mark.parametrize("name", NAMES)
def test_each_of_ours_keeps_the_contract(checked, name: str):
    assert [one for one in checked(name) if not one.passed] == []


def test_one_with_everything_human_keeps_it(checked):
    everything = {
        "visual_delay": 0.1, "vestibular_share": 0.5, "vestibular_delay": 0.05,
        "visual_roll_noise": 0.01, "visual_deviation_noise": 0.1, "vestibular_noise": 0.01,
        "proprioceptive_delay": 0.03, "proprioceptive_steer_noise": 0.01, "torque_limit": 3.0,
        "remnant_rms": 0.1, "grips": [[0.5, "hands-off"], [1.0, "tight"]],
    }  # fmt: skip
    assert [one for one in checked("hess2012", **everything) if not one.passed] == []


BROKEN = """
import math
import numpy as np

class Good:
    def __init__(self, setting, *, gain=1.0, other=0.5):
        self.gain, self.other, self.sum = gain, other, 0.0
    def intend(self, steer, steer_rate, seen):
        self.sum = self.sum + steer
        return self.gain * seen.roll + self.other * self.sum

class FloatsOnly(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * math.tanh(seen.roll) + self.other * steer

class FloatsOneByOne(FloatsOnly):
    batch = False

class ArraySine(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * np.sin(seen.roll) + self.other * steer

class Random(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll + self.other * np.random.rand()

class Shared(Good):
    counts = []
    def intend(self, steer, steer_rate, seen):
        self.counts.append(0)
        return self.gain * seen.roll + self.other * len(self.counts)

class Mixed(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll + self.other * np.mean(steer)

class Writes(Good):
    def intend(self, steer, steer_rate, seen):
        steer *= 2.0
        return self.gain * seen.roll + self.other * steer

class Idle(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll

class Nan(Good):
    def intend(self, steer, steer_rate, seen):
        return math.nan * steer

class Never(Good):
    def __init__(self, setting):
        raise RuntimeError("not today")
"""
ALL = {
    "can be made", "gives one finite number for floats", "gives the same again",
    "keeps his state to himself", "gives an array for arrays",
    "gives in a batch what he gives alone", "writes into no array that he is given",
    "every figure changes something",
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "broken"),
    [
        ("Good", set()),
        ("FloatsOneByOne", set()),
        ("ArraySine", set()),
        ("FloatsOnly", {"gives an array for arrays", "gives in a batch what he gives alone",
                        "writes into no array that he is given"}),
        ("Random", {"gives the same again", "keeps his state to himself",
                    "gives in a batch what he gives alone"}),
        ("Shared", {"gives the same again", "keeps his state to himself",
                    "gives in a batch what he gives alone"}),
        ("Mixed", {"gives in a batch what he gives alone"}),
        ("Writes", {"writes into no array that he is given"}),
        ("Idle", {"every figure changes something"}),
        ("Nan", ALL - {"can be made"}),
    ],
)  # fmt: skip
def test_the_check_finds_what_is_broken(checked, tmp_path: Path, name: str, broken: set[str]):
    file = tmp_path / "theirs.py"
    file.write_text(BROKEN)
    findings = checked(f"{file}:{name}")
    assert {one.what for one in findings} == ALL
    assert {one.what for one in findings if not one.passed} == broken


def test_one_who_cannot_be_made_is_asked_no_more(checked, tmp_path: Path):
    file = tmp_path / "theirs.py"
    file.write_text(BROKEN)
    (only,) = checked(f"{file}:Never")
    assert not only.passed
    assert "raised RuntimeError when made" in only.detail
    assert "not today" in only.detail


@pytest.mark.parametrize("name", [name for name in rider_names() if name.startswith("schwab")])
def test_an_identified_rider_steers_into_the_fall(make, seen, name: str):
    rider = make(name)
    assert [rider.torque(0.0, 0.0, seen(0.1, 0.1)) for _ in range(2000)][-1] > 0


@pytest.mark.parametrize("name", ["human", "pd"])
def test_the_default_rider_steers_into_the_fall(make, seen, name: str):
    rider = make(name, remnant_rms=0.0)
    assert [rider.torque(0.0, 0.0, seen(0.1, 0.1)) for _ in range(2000)][-1] > 0


@pytest.mark.parametrize("name", ["human", "pd", "schwab2013-184", "hess2012", "lqr"])
def test_another_seed_gives_another_remnant(make, seen, name: str):
    first, second = (
        [make(name, seed, remnant_rms=0.1).torque(0.0, 0.0, seen()) for _ in range(3)]
        for seed in (1, 2)
    )
    assert first != second


def test_hands_off_there_is_no_torque(make, seen):
    rider = make("hands-off")
    assert {rider.torque(0.3, 1.0, seen(0.1, 0.3)) for _ in range(100)} == {0.0}
    assert rider.arms == Arms(0, 0, 0)
    assert np.all(np.isfinite(rider.arms))
