from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.model.parameters import BicycleParameters
from bikesim.model.whipple import Matrices, whipple_matrices

# [M07], section 5(a): the benchmark bicycle.
PUBLISHED = {
    "M": [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]],
    "C1": [[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]],
    "K0": [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]],
    "K2": [[0, 76.59734589573222], [0, 2.65431523794604]],
}


def _benchmark() -> BicycleParameters:
    parameters = bicycles.load("benchmark").parameters
    assert parameters is not None
    return parameters


# Bicycles of every shape around the benchmark, with negative trail and tilt among them.
SHAPES = st.fixed_dictionaries(
    {name: st.floats(0.8, 1.25) for name in asdict(_benchmark()) if name not in ("c", "lam")},
).flatmap(
    lambda factors: st.builds(
        lambda c, lam: BicycleParameters(
            **{name: asdict(_benchmark())[name] * factor for name, factor in factors.items()},
            c=c,
            lam=lam,
        ),
        c=st.floats(-0.1, 0.1),
        lam=st.floats(-0.8, 0.8),
    )
)


def scaled(p: BicycleParameters, s: float) -> BicycleParameters:
    """The same shape with every mass and inertia times s."""
    return replace(p, **{key: x * s for key, x in asdict(p).items() if key[0] in "mI"})


def kinetic_energy(p: BicycleParameters, phi_dot: float, delta_dot: float) -> float:
    """Of the upright bicycle at rest, body by body: rigid-body velocities, no [M07] formula."""
    psi_dot = p.c * np.cos(p.lam) / p.w * delta_dot  # the front contact does not slip sideways
    rear = np.array([phi_dot, 0, psi_dot])
    axis = np.array([np.sin(p.lam), 0, np.cos(p.lam)])
    front = rear + delta_dot * axis
    on_axis = np.array([p.w + p.c, 0, 0])

    def energy(mass, x, z, inertia, of_front) -> float:
        r = np.array([x, 0, z])
        velocity = np.cross(rear, r) + of_front * delta_dot * np.cross(axis, r - on_axis)
        omega = front if of_front else rear
        Ixx, Iyy, Izz, Ixz = inertia
        tensor = np.array([[Ixx, 0, Ixz], [0, Iyy, 0], [Ixz, 0, Izz]])
        return float(mass * velocity @ velocity + omega @ tensor @ omega) / 2

    return (
        energy(p.mR, 0, -p.rR, (p.IRxx, p.IRyy, p.IRxx, 0), False)
        + energy(p.mB, p.xB, p.zB, (p.IBxx, p.IByy, p.IBzz, p.IBxz), False)
        + energy(p.mH, p.xH, p.zH, (p.IHxx, p.IHyy, p.IHzz, p.IHxz), True)
        + energy(p.mF, p.w, -p.rF, (p.IFxx, p.IFyy, p.IFxx, 0), True)
    )


@pytest.mark.parametrize("name", PUBLISHED)
def test_benchmark_has_the_published_matrices(name):
    matrix = getattr(whipple_matrices(_benchmark()), name)
    np.testing.assert_allclose(matrix, PUBLISHED[name], rtol=0, atol=1e-12)


@given(SHAPES)
@settings(max_examples=30, deadline=None)
def test_mass_matrix_is_that_of_the_kinetic_energy(p):
    T = kinetic_energy
    M_pp, M_dd = 2 * T(p, 1, 0), 2 * T(p, 0, 1)
    M_pd = T(p, 1, 1) - T(p, 1, 0) - T(p, 0, 1)
    M = whipple_matrices(p).M
    np.testing.assert_allclose(M, [[M_pp, M_pd], [M_pd, M_dd]], rtol=1e-10, atol=1e-10)


@given(SHAPES)
@settings(max_examples=30, deadline=None)
def test_structure(p):
    m = whipple_matrices(p)
    assert m.M[0, 1] == m.M[1, 0]
    assert m.K0[0, 1] == m.K0[1, 0]
    assert m.C1[0, 0] == 0
    assert not m.K2[:, 0].any()


@given(SHAPES, st.floats(0.1, 10))
@settings(max_examples=30, deadline=None)
def test_matrices_scale_with_the_masses(p, s):
    one, many = whipple_matrices(p), whipple_matrices(scaled(p, s))
    for name in PUBLISHED:
        np.testing.assert_allclose(
            getattr(many, name), s * getattr(one, name), rtol=1e-12, atol=1e-12
        )


def test_damping_grows_with_speed():
    m = whipple_matrices(_benchmark())
    np.testing.assert_array_equal(m.damping(3.5), 3.5 * m.C1)


def test_stiffness_has_gravity_and_speed_squared():
    m = whipple_matrices(_benchmark())
    np.testing.assert_array_equal(m.stiffness(3.0, 9.81), 9.81 * m.K0 + 9.0 * m.K2)


def test_matrices_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        whipple_matrices(_benchmark()).M[0, 0] = 1


@pytest.mark.parametrize(
    ("M", "what"),
    [
        ([[1, 2], [2, 1]], "positive definite"),
        ([[-1, 0], [0, -1]], "positive definite"),
        ([[2, 1], [0, 2]], "symmetric"),
        ([[np.nan, 0], [0, 1]], "finite"),
        ([1, 2], "2 x 2"),
    ],
)
def test_refuses_a_mass_matrix_of_no_bicycle(M, what):
    zero = np.zeros((2, 2))
    with pytest.raises(InputError, match=what):
        Matrices(np.array(M), zero, zero, zero)
