import math
from dataclasses import replace

import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.model.parameters import PARAMETER_NAMES, BicycleParameters


@pytest.fixture(scope="module")
def benchmark() -> BicycleParameters:
    parameters = bicycles.load("benchmark").parameters
    assert parameters is not None
    return parameters


def test_there_are_25():
    assert len(PARAMETER_NAMES) == 25


@pytest.mark.parametrize("name", PARAMETER_NAMES)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_refuses_what_is_not_finite(benchmark, name, value):
    with pytest.raises(InputError, match=f"{name} = .*must be finite"):
        replace(benchmark, **{name: value})


@pytest.mark.parametrize("name", ["w", "rR", "mB", "mF", "IRxx", "IByy", "IHzz", "IFyy"])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_refuses_what_must_be_positive(benchmark, name, value):
    with pytest.raises(InputError, match=f"{name} = .*above 0"):
        replace(benchmark, **{name: value})


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("c", 1e150, "-100 to 100 m"),
        ("w", 1e-300, "0.001 to 100 m"),
        ("rF", 1e9, "0.001 to 100 m"),
        ("zB", -1e3, "-100 to 100 m"),
        ("mB", 1e-9, "0.001 to 100000 kg"),
        ("IFyy", 1e-30, "1e-09 to 1e+06 kg m²"),
        ("IBxz", -1e9, r"-1e\+06 to 1e\+06 kg m²"),
    ],
)
def test_refuses_what_is_far_beyond_any_bicycle(benchmark, name, value, allowed):
    allowed = allowed.replace("to 1e+", r"to 1e\+")
    with pytest.raises(InputError, match=f"{name} = .*must be from {allowed}"):
        replace(benchmark, **{name: value})


def test_refuses_a_tilt_in_degrees(benchmark):
    with pytest.raises(InputError, match=r"lam = 18\.0.*radians"):
        replace(benchmark, lam=18.0)


@pytest.mark.parametrize("name", ["zB", "zH"])
def test_refuses_a_centre_of_mass_below_ground(benchmark, name):
    with pytest.raises(InputError, match=f"{name} = 0.9.*below 0"):
        replace(benchmark, **{name: 0.9})


@pytest.mark.parametrize("name", ["IBxz", "IHxz"])
def test_refuses_an_inertia_that_is_not_positive_definite(benchmark, name):
    with pytest.raises(InputError, match=f"{name} = 100.0.*not positive definite"):
        replace(benchmark, **{name: 100.0})


def test_allows_a_negative_trail_and_tilt(benchmark):
    assert replace(benchmark, c=-0.05, lam=-0.1).c == -0.05
