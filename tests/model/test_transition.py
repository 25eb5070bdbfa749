import numpy as np
import pytest
from scipy.linalg import expm

from bikesim.model.transition import transition


def first_order_hold(step: float, stiffness: float, damping: float) -> np.ndarray:
    """Φ, Ψ0, Ψ1 from one exponential: the input u and its slope are states of their own."""
    A = np.array([[0, 1], [-stiffness, -damping]])
    zero, one = np.zeros((2, 2)), np.eye(2)
    generator = np.block([[A, one, zero], [zero, zero, one], [zero, zero, zero]])
    moved = expm(generator * step)[:2]
    of_slope = moved[:, 4:] / step
    return np.concatenate([moved[:, :2], moved[:, 2:4] - of_slope, of_slope], axis=0)


# Bicycle (unstable), pendulum, damped roll, muscle [H12], no force at all.
SYSTEMS = [(-9.82, 0.0), (9.82, 0.0), (-9.8, 0.4), (900.0, 42.4), (0.0, 0.0), (0.0, 3.0)]


@pytest.mark.parametrize(("stiffness", "damping"), SYSTEMS)
@pytest.mark.parametrize("step", [1e-5, 1e-3, 0.02, 0.1])
def test_a_step_is_scipys_exponential(step: float, stiffness: float, damping: float):
    ours = np.reshape(transition(step, stiffness, damping), (6, 2))
    theirs = first_order_hold(step, stiffness, damping)
    assert ours == pytest.approx(theirs, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("stiffness", "damping"), [(1e6, 1414.0), (1e4, 2000.0), (-9.82, 0.0)])
@pytest.mark.parametrize("step", [0.01, 1.0])
def test_a_step_much_longer_than_the_system_is_quick(step: float, stiffness: float, damping: float):
    ours = np.reshape(transition(step, stiffness, damping), (6, 2))
    theirs = first_order_hold(step, stiffness, damping)
    assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-12)


def test_no_time_changes_nothing():
    nothing = [0.0] * 8
    assert transition(0.0, -9.82, 0.3) == pytest.approx([1, 0, 0, 1, *nothing], abs=0)


def test_arrays_give_what_floats_give():
    stiffness, damping = np.array([-9.8, 3.0, 0.0]), np.array([0.1, 2.0, 0.0])
    together = np.array(transition(0.004, stiffness, damping))
    for i in range(3):
        alone = transition(0.004, float(stiffness[i]), float(damping[i]))
        assert together[:, i].tolist() == list(alone)


def test_two_steps_are_one_of_double_length():
    phi = np.reshape(transition(0.01, -9.82, 0.3)[:4], (2, 2))
    twice = np.reshape(transition(0.02, -9.82, 0.3)[:4], (2, 2))
    assert phi @ phi == pytest.approx(twice, rel=1e-14)


def test_numpy_scalars_do_not_come_back_to_floats():
    """Equal keys of another type are other keys: a loop of floats must stay one."""
    step, stiffness, damping = 0.001234, -9.8, 0.25
    transition(np.float64(step), np.float64(stiffness), np.float64(damping))
    assert {type(entry) for entry in transition(step, stiffness, damping)} == {float}
