"""A rider of one's own: found, given his figures, and stopped with one line when he goes wrong."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.experiment.batch import batch_key, ride_batch
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario, StartSettings, read_toml
from bikesim.model.haptic import BicycleState
from bikesim.record.channels import TICK_CHANNELS
from bikesim.rider.base import Rider
from bikesim.rider.custom import class_figures, load_class
from bikesim.rider.settings import RiderSettings

ROLL = [channel.name for channel in TICK_CHANNELS].index("roll")
THEIRS = """
from __future__ import annotations
import dataclasses
import math
import numpy as np
from helper import HALF

@dataclasses.dataclass
class Note:
    text: str = ""

class Mine:
    def __init__(self, setting, *, gain=1.0, steps=3, name="x", flag=True):
        self.gain, self.steps, self.asked = gain, steps, -1
    def intend(self, steer, steer_rate, seen):
        self.asked += 1
        return self.torque(seen) if self.asked > 100 else 2 * HALF * self.gain * seen.roll
    def torque(self, seen):
        return 0.0 * seen.roll

class Raises(Mine):
    def torque(self, seen):
        return 1 / 0
class Nan(Mine):
    def torque(self, seen):
        return math.nan * seen.roll
class Nothing(Mine):
    def torque(self, seen):
        return None
class Exits(Mine):
    def torque(self, seen):
        raise SystemExit(0)
class Text(Mine):
    def torque(self, seen):
        return "left"
class Shape(Mine):
    def torque(self, seen):
        return np.zeros(7)
class Where(Mine):
    def intend(self, steer, steer_rate, seen):
        return np.where(seen.roll > 0, 0.25, -0.25)
class Same(Mine):
    def intend(self, steer, steer_rate, seen):
        return np.array(0.25)
class Infinite(Mine):
    def torque(self, seen):
        return np.array(math.inf)
class Positional(Mine):
    def __init__(self, setting, gain):
        pass
class NoBrain:
    pass
"""


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file that has been named by where one stands."""
    (tmp_path / "theirs.py").write_text(THEIRS)
    (tmp_path / "helper.py").write_text("HALF = 0.5\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, "helper", raising=False)
    return tmp_path


def test_his_figures_are_the_keywords_with_numbers(theirs: Path):
    del theirs
    assert class_figures("theirs.py:Mine") == {"gain": 1.0, "steps": 3.0}


def test_he_gets_the_figures_that_are_given(theirs: Path, make, seen):
    del theirs
    assert make("theirs.py:Mine").torque(0.0, 0.0, seen(0.1)) == 0.1
    given = make("theirs.py:Mine", figures={"gain": 3.0})
    assert given.torque(0.0, 0.0, seen(0.1)) == pytest.approx(0.3)


def test_each_of_many_gets_his_own(theirs: Path, make_many, seen):
    """Who was given none has that of the class."""
    del theirs
    given = [{"gain": 2.0}, {}, {"gain": 4.0}]
    many = make_many([RiderSettings(name="theirs.py:Mine", figures=one) for one in given])
    torques = many.torque(np.zeros(3), np.zeros(3), seen(np.full(3, 0.5)))
    assert torques.tolist() == [1.0, 0.5, 2.0]


@pytest.mark.parametrize(("name", "alone"), [("Where", -0.25), ("Same", 0.25)])
def test_an_array_without_dimensions_is_a_number(
    theirs: Path, make, make_many, seen, name: str, alone: float
):
    """As np.where gives one for floats."""
    del theirs
    torque = make(f"theirs.py:{name}").torque(0.0, 0.0, seen(-0.1))
    assert (type(torque), torque) == (float, alone)
    many = make_many([RiderSettings(name=f"theirs.py:{name}")] * 3)
    torques = many.torque(np.zeros(3), np.zeros(3), seen(np.array([0.1, -0.1, 0.1])))
    assert torques.tolist() == [0.25, alone, 0.25]


def test_he_may_have_a_body(theirs: Path, make, seen):
    del theirs
    rider = make("theirs.py:Mine", visual_delay=0.01, arm_damping=2.0, torque_limit=0.3)
    torques = [rider.torque(0.0, 0.0, seen(1.0)) for _ in range(30)]
    assert torques == [0.0] * 20 + [0.3] * 10
    assert rider.arms == (0.0, 2.0, 0.0)


def test_one_by_one_in_a_batch_when_he_says_so(theirs: Path, make_many, seen):
    (theirs / "single.py").write_text(
        "import math\n"
        "class Single:\n"
        "    batch = False\n"
        "    def __init__(self, setting, *, gain=1.0):\n"
        "        self.gain, self.speed = gain, math.floor(setting.speed)\n"
        "    def intend(self, steer, steer_rate, seen):\n"
        "        return self.gain * self.speed if seen.roll > 0 else math.copysign(1, steer)\n"
    )
    settings = [
        RiderSettings(name="single.py:Single", figures={"gain": g}) for g in (1.0, 2.0, 3.0)
    ]
    many = make_many(settings, speed=np.array([3.5, 4.5, 5.5]))
    bicycle = seen(np.array([0.1, -0.1, 0.1]), np.zeros(3))
    assert many.torque(np.full(3, -0.2), np.zeros(3), bicycle).tolist() == [3.0, -1.0, 15.0]


WRONG = (
    ("Raises", "raised ZeroDivisionError at 0.0505 s (theirs.py, line 23): division by zero", ""),
    ("Nan", "gave nan at 0.0505 s: must be a finite number", "gave nan for rider 1 of 3 at 0.0505"),
    ("Exits", "raised SystemExit at 0.0505 s (theirs.py, line 32): 0", ""),
    ("Nothing", "gave None at 0.0505 s: must be a finite number", "gave None at 0.0505 s: must be"),
    ("Text", "gave 'left' at 0.0505 s: must be a finite number", "gave 'left' at 0.0505 s: must"),
    ("Infinite", "gave inf at 0.0505 s: must be a finite number", "gave inf for rider 1 of 3 at"),
    ("Shape", "gave an array of shape (7,) at 0.0505 s: must be", "of shape (7,) at 0.0505 s: mus"),
)


@pytest.mark.parametrize(("name", "alone", "together"), WRONG)
def test_what_he_does_wrong_is_one_line_with_the_time(
    theirs: Path, make, make_many, seen, name: str, alone: str, together: str
):
    del theirs
    zeros, shown = np.zeros(3), seen(np.full(3, 0.1))
    assert alone in told(make(f"theirs.py:{name}"), 0.0, seen(0.1))
    many = make_many([RiderSettings(name=f"theirs.py:{name}")] * 3)
    assert (together or alone) in told(many, zeros, shown)


def told(rider: Rider, steer, shown: BicycleState) -> str:
    with pytest.raises(InputError) as error:
        ridden(rider, steer, shown)
    assert "\n" not in str(error.value)
    return str(error.value)


def ridden(rider: Rider, steer, shown: BicycleState) -> None:
    for _ in range(200):
        rider.torque(steer, steer, shown)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nofile.py:Mine", "there is no file nofile.py"),
        ("theirs.py:Mina", "unknown class in theirs.py 'Mina'; did you mean Mine"),
        ("helper.py:Mine", "helper.py has no class with a method intend"),
        ("theirs.py:NoBrain", "must be a class with a method intend"),
        ("theirs.py:Positional", "gain of its __init__ must have a default"),
        ("not_there_at_all:Mine", "there is no module not_there_at_all; a file is named as in"),
        ("json:dumps", "must be a class with a method intend"),
        (
            "imports.py:X",
            "raised ModuleNotFoundError when imported (imports.py, line 1): No module",
        ),
        ("syntax.py:X", "raised SyntaxError when imported"),
        ("leaves.py:X", "raised SystemExit when imported (leaves.py, line 2): 3"),
        ("makes.py:X", "raised KeyError when made (makes.py, line 2): 'no'"),
    ],
)
def test_one_who_is_not_there_or_cannot_be_made(theirs: Path, make, name: str, message: str):
    (theirs / "imports.py").write_text("import not_there_at_all\n")
    (theirs / "syntax.py").write_text("class (:\n")
    (theirs / "leaves.py").write_text("import sys\nsys.exit(3)\n")
    (theirs / "makes.py").write_text(
        "class X:\n"
        "    def __init__(self, setting): raise KeyError('no')\n"
        "    def intend(self): ...\n"
    )
    with pytest.raises(InputError) as error:
        make(name)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_figure_that_he_has_not_is_refused(theirs: Path, make):
    del theirs
    with pytest.raises(InputError, match=r"figures.gian = 2: .* it has: gain, steps"):
        make("theirs.py:Mine", figures={"gian": 2.0})


def test_a_file_that_has_changed_is_read_again(theirs: Path):
    file = theirs / "changes.py"
    text = "class X:\n    level = {}\n    def intend(self, steer, steer_rate, seen): ...\n"
    for level in (1, 2):
        file.write_text(text.format(level))
        os.utime(file, ns=(level, level))
        assert load_class("changes.py:X").level == level
    assert load_class("changes.py:X") is load_class("changes.py:X")


def test_what_is_imported_leaves_the_search_path_as_it_was(theirs: Path):
    before = list(sys.path)
    load_class("theirs.py:Mine")
    assert sys.path == before
    assert str(theirs) not in sys.path


def test_a_scenario_finds_him_beside_itself(theirs: Path, monkeypatch: pytest.MonkeyPatch):
    folder = theirs / "inner"
    folder.mkdir()
    monkeypatch.chdir(folder)
    scenario = theirs / "ride.toml"
    scenario.write_text('rider = "theirs.py:Mine"\n')
    assert read_toml(scenario)["rider"] == f"{theirs / 'theirs.py'}:Mine"


def test_a_run_with_him_ends_with_his_line(theirs: Path):
    del theirs
    parts = build(Scenario(rider=RiderSettings(name="theirs.py:Raises"), duration=1.0))

    class Nowhere:
        def append(self, row) -> None: ...

    with pytest.raises(InputError, match=r"raised ZeroDivisionError at 0.0505 s"):
        ride_parts(parts, Nowhere())


def test_a_batch_has_him_with_several_figures(theirs: Path):
    del theirs
    scenarios = [
        Scenario(
            rider=RiderSettings(name="theirs.py:Mine", figures=figures, arm_damping=3.0),
            start=StartSettings(roll_deg=2.0),
            duration=0.5,
        )
        for figures in ({"gain": 3.0}, {}, {"gain": 5.0, "steps": 2.0})
    ]
    assert len({batch_key(one) for one in scenarios}) == 1
    for scenario, outcome in zip(scenarios, ride_batch(scenarios), strict=True):
        rows: list[tuple[float, ...]] = []

        class Rows:
            append = staticmethod(rows.append)

        ride_parts(build(scenario), Rows())
        assert outcome.history.roll.tolist() == [row[ROLL] for row in rows][::10]
