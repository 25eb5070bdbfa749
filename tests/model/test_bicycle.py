from dataclasses import replace

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.whipple import whipple_matrices


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return bicycles.load("benchmark")


def test_geometry_comes_from_the_parameters(benchmark):
    assert (benchmark.wheelbase, benchmark.trail) == (1.02, 0.08)
    assert benchmark.steer_axis_tilt == np.pi / 10


def test_matrices_come_from_the_parameters(benchmark):
    np.testing.assert_array_equal(benchmark.matrices.K2, whipple_matrices(benchmark.parameters).K2)


def test_with_gravity_changes_nothing_else(benchmark):
    moon = benchmark.with_gravity(1.62)
    assert moon.gravity == 1.62
    assert moon.matrices is benchmark.matrices
    assert benchmark.gravity == 9.81


@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("wheelbase", 0.0, "above 0"),
        ("wheelbase", np.inf, "above 0"),
        ("trail", np.nan, "finite"),
        ("steer_axis_tilt", 18.0, "in radians"),
        ("steer_axis_tilt", np.nan, "in radians"),
        ("gravity", -9.81, "from 0 to 100"),
        ("gravity", np.nan, "from 0 to 100"),
    ],
)
def test_refuses_what_is_out_of_range(benchmark, field, value, allowed):
    with pytest.raises(InputError, match=f"bicycle benchmark: .* = {value}: .*{allowed}"):
        replace(benchmark, **{field: value})
