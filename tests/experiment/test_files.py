"""Files that a scenario names are sought beside the file that names them."""

from pathlib import Path

import pytest

from bikesim import bicycles
from bikesim.experiment.files import beside
from bikesim.experiment.run import build
from bikesim.experiment.scenario import Scenario, read_toml

RIDE = """
duration = 0.1
bicycle = "mine.toml"
rig = { name = "bar.toml", coulomb_friction = 0.01 }
path = { kind = "csv", file = "track.csv" }
[rider]
name = "torque-file"
script = { file = "data/torque.csv" }
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scenario with all that it names, seen from elsewhere."""
    folder = tmp_path / "study"
    (folder / "data").mkdir(parents=True)
    (folder / "ride.toml").write_text(RIDE)
    (folder / "mine.toml").write_text(bicycles.to_toml(bicycles.load("benchmark")))
    (folder / "bar.toml").write_text("viscous_friction = 0.02\n")
    (folder / "track.csv").write_text("x,y\n" + "".join(f"{5 * i},0\n" for i in range(9)))
    (folder / "data" / "torque.csv").write_text("0, 0.1\n1, 0.1\n")
    monkeypatch.chdir(tmp_path)
    return folder


def test_every_kind_of_file_is_found_there(folder: Path):
    scenario = Scenario(**read_toml(Path("study/ride.toml")))
    assert scenario.bicycle == "study/mine.toml"
    assert (scenario.rig.name, scenario.rig.viscous_friction) == ("study/bar.toml", 0.02)
    assert scenario.path.points is not None
    assert scenario.rider.script is not None
    assert scenario.rider.script.file == "study/data/torque.csv"
    build(scenario).rig.close()
    assert beside({"path": "track.csv"}, folder) == {"path": str(folder / "track.csv")}


def test_then_in_the_current_folder(folder: Path):
    for name in ("mine.toml", "track.csv"):
        (folder / name).rename(Path(name))
    scenario = Scenario(**read_toml(Path("study/ride.toml")))
    assert scenario.bicycle == "mine.toml"
    assert scenario.path.file == "track.csv"
    build(scenario).rig.close()


def test_a_frame_and_its_rider_are_two_files(folder: Path):
    (folder / "me.txt").touch()
    assert beside("mine.toml+me.txt", folder) == f"{folder / 'mine.toml'}+{folder / 'me.txt'}"
    assert beside("browser+me.txt", folder) == f"browser+{folder / 'me.txt'}"


@pytest.mark.parametrize("value", ["human", "package.module:Rider", "gone.csv", "", 3.5, [[0, 1]]])
def test_what_is_no_file_there_stays_as_it_is(folder: Path, value: object):
    assert beside({"a": [value]}, folder) == {"a": [value]}
