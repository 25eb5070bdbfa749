"""bikesim rider"""

import json
from pathlib import Path

import pytest

from bikesim.cli.main import main
from bikesim.rider.kinds import HUMAN_KEYS, rider_names

MINE = """
class Good:
    def __init__(self, setting, *, gain=1.0):
        self.gain = gain
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll

class Mixed(Good):
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll + max(abs(steer)) if hasattr(steer, "shape") else 0.0
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    monkeypatch.chdir(tmp_path)


def test_all_riders_are_listed(capsys: pytest.CaptureFixture[str]):
    assert main(["rider", "list"]) == 0
    text = capsys.readouterr().out
    assert all(name in text for name in (*rider_names(), *HUMAN_KEYS))
    assert "roll_gain 0.43" in text


def test_the_list_as_json(capsys: pytest.CaptureFixture[str]):
    assert main(["rider", "list", "--json"]) == 0
    listed = {one["name"]: one for one in json.loads(capsys.readouterr().out)}
    assert tuple(listed) == rider_names()
    assert listed["pd"]["figures"] == {"roll_gain": 3.0, "roll_rate_gain": 5.0}


def test_one_who_keeps_the_contract(mine: None, capsys: pytest.CaptureFixture[str]):
    assert main(["rider", "check", "mine.py:Good"]) == 0
    lines = capsys.readouterr().out.splitlines()[2:]
    assert len(lines) == 8
    assert all(line.startswith("ok  ") for line in lines)


def test_one_who_does_not(mine: None, capsys: pytest.CaptureFixture[str]):
    assert main(["rider", "check", "mine.py:Mixed", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert not told["passed"]
    broken = [one["what"] for one in told["findings"] if not one["passed"]]
    assert "gives in a batch what he gives alone" in broken


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("", "is missing"),
        ("check", "rider check: a rider is missing"),
        ("chek human", "unknown action 'chek'; did you mean check?"),
        ("list human", "rider list: unexpected argument human"),
        ("check humann", "unknown rider 'humann'; did you mean human?"),
        ("check none.py:Mine", "there is no file none.py"),
        ("check human --speed 0", "--speed 0.0: must be above 0"),
        ("check human --bicycle unicycle", "unknown bicycle 'unicycle'"),
    ],
)
def test_bad_input_is_one_line(
    mine: None, capsys: pytest.CaptureFixture[str], arguments: str, message: str
):
    assert main(["rider", *arguments.split()]) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert len(told.err.splitlines()) == 1
