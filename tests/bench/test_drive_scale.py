import math

import pytest

from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.rated_torque import check_rated_torque
from bikesim.errors import InputError


def settings(**given) -> Cia402Settings:
    usual = {
        "node": 5, "rated_torque": 0.5, "torque_unit": "mNm", "gear": 4.0,
        "encoder_counts": 4096, "torque_limit": 3.0,
    }  # fmt: skip
    return Cia402Settings(**{**usual, **given})


@pytest.mark.parametrize(("torque", "units"), [(0.0, 0), (2.0, 1000), (-1.0, -500), (0.0011, 1)])
def test_torque_is_per_mille_of_the_rated_at_the_shaft(torque: float, units: int):
    """2 N m at the axis are 0.5 N m, the rated torque, at the shaft of a gear of 4."""
    assert settings().scale.to_drive(torque) == units
    assert settings(direction=-1).scale.to_drive(torque) == -units
    assert settings().scale.torque(units) == pytest.approx(torque, abs=0.001)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("limit", [0.1, 1.0, 3.0, 3.5, 2.9999])
def test_the_limit_holds_in_the_drives_units(limit: float, direction: int):
    scale = settings(torque_limit=limit, direction=direction).scale
    for torque in (1e300, -1e300, 10.0, -10.0, limit, -limit):
        sent = scale.torque(scale.to_drive(torque))
        assert abs(sent) <= limit * (1 + 1e-9)
        assert abs(sent) > limit - 0.002 - 1e-9
        assert sent * torque > 0


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_zero(torque: float):
    assert settings().scale.to_drive(torque) == 0


@pytest.mark.parametrize("direction", [1, -1])
def test_a_turn_of_the_motor_is_a_fourth_of_a_turn_of_the_bar(direction: int):
    scale = settings(direction=direction).scale
    assert scale.steer(4096) == pytest.approx(direction * math.pi / 2)


@pytest.mark.parametrize(("unit", "units"), [("rpm", 60), ("mrpm", 60000), ("counts/s", 4096)])
def test_a_turn_a_second_of_the_motor(unit: str, units: int):
    assert settings(velocity_unit=unit).scale.steer_rate(units) == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(("raw", "unit"), [(386000, "uNm"), (386, "mNm"), (380, "mNm")])
def test_a_rated_torque_that_is_the_nameplates(raw: int, unit: str):
    assert check_rated_torque(raw, unit, 0.386) == pytest.approx(0.386, rel=0.02)


@pytest.mark.parametrize(
    ("raw", "unit", "told"),
    [
        (386000, "mNm", "its unit is uNm, set torque_unit"),
        (386, "uNm", "its unit is mNm, set torque_unit"),
        (500, "mNm", "set the drive or rated_torque"),
        (0, "mNm", "set the drive or rated_torque"),
    ],
)
def test_a_unit_that_contradicts_the_nameplate_is_refused(raw: int, unit: str, told: str):
    with pytest.raises(InputError, match=told):
        check_rated_torque(raw, unit, 0.386)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"node": 0}, "drive.node = 0: must be"),
        ({"torque_unit": "Nm"}, "drive.torque_unit = 'Nm': must be"),
        ({"direction": 0}, "drive.direction = 0: must be"),
        ({"torque_limit": 11.0}, "drive.torque_limit = 11.0: must be"),
        ({"torque_limit": 9.0, "rated_torque": 0.1}, "more than 10 times rated torque"),
        ({"torque_limit": 0.001}, "less than a thousandth"),
        ({"host_node": 5}, "is the drive's own node"),
        ({"gaer": 2.0}, "did you mean gear"),
        ({"objects": ({"index": 5, "value": 1},)}, "drive.objects.index = 5: must be"),
        ({"heartbeat_timeout": 1.0}, "heartbeat_timeout = 1.0: must be"),
    ],
    ids=str,
)
def test_a_profile_that_cannot_be_is_refused_in_one_line(given: dict, told: str):
    with pytest.raises(InputError) as error:
        settings(**given)
    assert told in str(error.value)
    assert "\n" not in str(error.value)
