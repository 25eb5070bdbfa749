import math
import tomllib
from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.rig.settings import RigSettings, rig_names

rigs = pytest.mark.parametrize("name", rig_names())


@rigs
def test_a_rig_that_ships_says_what_it_is(name: str):
    rig = RigSettings(name=name)
    assert rig.name == name
    assert rig.description


@rigs
def test_each_figure_of_a_rig_that_ships_has_its_source_beside_it(repository: Path, name: str):
    text = (repository / "hardware" / "rigs" / f"{name}.toml").read_text("utf-8")
    figures = tomllib.loads(text).keys() - {"description"}
    assert not figures or "#" in text


def test_the_figures_of_the_2013_rig():
    """SCIENCE and HARDWARE: 10-bit potentiometer, gyro in 0.244 deg/s, 3.58 N m."""
    rig = RigSettings(name="delft2013")
    assert rig.angle_resolution == pytest.approx(2.77e-3)
    assert math.degrees(rig.rate_resolution) == pytest.approx(0.244, abs=1e-4)
    assert rig.torque_limit == pytest.approx(0.217 * 3.0 * 5.5, abs=2e-3)
    assert rig.sensor_interval == pytest.approx(1 / 50)


def test_the_figures_of_phobos():
    rig = RigSettings(name="phobos")
    assert rig.inertia == 0.0427
    assert rig.angle_resolution == pytest.approx(2 * math.pi / 152_000, rel=1e-5)
    assert rig.torque_limit == 10.78125


def test_a_name_alone_is_the_ideal_rig():
    rig = RigSettings()
    assert (rig.name, rig.torque_limit, rig.filter_cutoff, rig.inertia) == (
        "ideal",
        None,
        None,
        None,
    )


def test_a_figure_beside_the_name_replaces_the_names():
    rig = RigSettings(name="phobos", motor_lag=0.05)
    assert (rig.motor_lag, rig.inertia) == (0.05, 0.0427)


@rigs
def test_resolved_settings_are_settings(name: str):
    rig = RigSettings(name=name)
    assert RigSettings(**rig.model_dump()) == rig


def test_a_rig_may_come_from_a_file(tmp_path: Path):
    (tmp_path / "mine.toml").write_text('description = "mine"\ncoulomb_friction = 0.1\n')
    rig = RigSettings(name=str(tmp_path / "mine.toml"))
    assert (rig.description, rig.coulomb_friction) == ("mine", 0.1)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"name": "idael"}, "unknown rig 'idael'; did you mean ideal?"),
        ({"name": "nowhere.toml"}, "nowhere.toml: "),
        ({"angle_nois": 1.0}, "did you mean angle_noise"),
        ({"inertia": 0.0}, "inertia = 0.0: must be"),
        ({"angle_noise": -1.0}, "angle_noise = -1.0: must be"),
        ({"rate_bias": math.nan}, "rate_bias = nan: must be"),
        ({"torque_limit": 0.0}, "torque_limit = 0.0: must be"),
        ({"filter_order": 5}, "filter_order = 5: must be"),
        ({"filter_order": 1.5}, "filter_order = 1.5: must be"),
        ({"steer_stop_deg": 200.0}, "steer_stop_deg = 200.0: must be"),
        ({"motor_lag": "quick"}, "motor_lag = 'quick': must be"),
        ({"name": None}, "name = None: must be"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_in_one_line(given: dict, message: str):
    with pytest.raises(InputError) as error:
        RigSettings(**given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "content",
    [b"motor_lag = ", b"\xff\xfe\x00", b"motor_lagg = 1\n", b"motor_lag = -1\n"],
    ids=repr,
)
def test_a_file_that_is_no_rig_is_refused_in_one_line(tmp_path: Path, content: bytes):
    (tmp_path / "bad.toml").write_bytes(content)
    with pytest.raises(InputError) as error:
        RigSettings(name=str(tmp_path / "bad.toml"))
    assert "\n" not in str(error.value)


def test_a_folder_is_no_rig(tmp_path: Path):
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(InputError, match=r"folder\.toml"):
        RigSettings(name=str(tmp_path / "folder.toml"))
