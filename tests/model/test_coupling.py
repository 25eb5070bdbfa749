from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.coupling import CoupledBicycle, Coupling, virtual_coupling
from bikesim.model.law import Law
from bikesim.model.margins import margin_at, sampled_modes
from bikesim.model.sampled_loop import SampledLoop, controller, with_coupling
from bikesim.model.simulator import handlebar_inertia, simulator_matrices

COUPLING = Coupling(0.1884, 223.0, 5.57)


def test_the_handle_moves_as_scipy_has_it(benchmark: Bicycle):
    """Law off: the handle alone, J δ̈_h = k (δ - δ_h) + b (δ̇ - δ̇_h), the bar swung by hand.

    What goes in, k δ + b δ̇, is taken straight between the samples.
    """
    coupled = CoupledBicycle(benchmark, Law.OFF, COUPLING)
    J, k, b = COUPLING
    time = np.linspace(0, 0.5, 501)
    bar, rate = 0.2 * np.sin(9 * time), 1.8 * np.cos(9 * time)
    state = coupled.start(steer=float(bar[0]), steer_rate=float(rate[0]), speed=4.0)
    torques = [state.feedback_torque]
    for t, angle, turning in zip(time[1:], bar[1:], rate[1:], strict=True):
        state = coupled.step(state, float(t), float(angle), float(turning), 4.0)
        torques.append(state.feedback_torque)

    def slope(t: float, x: np.ndarray) -> list[float]:
        pull = np.interp(t, time, k * bar + b * rate)
        return [x[1], (pull - k * x[0] - b * x[1]) / J]

    solved = solve_ivp(
        slope, (0, 0.5), [bar[0], rate[0]], t_eval=time, rtol=1e-9, atol=1e-12, max_step=1e-3
    )
    handle, turning = solved.y
    felt = k * (handle - bar) + b * (turning - rate)
    assert state.steer == pytest.approx(handle[-1], abs=1e-8)
    assert np.abs(np.array(torques) - felt).max() < 1e-4


def test_a_stiff_coupling_makes_the_bar_as_heavy_as_asked(benchmark: Bicycle):
    """Slow modes are those of the continuous simulator with the inertia of both."""
    light = SampledLoop(0.0427, 1e-4)
    loop = with_coupling(light, 1.0, benchmark, Law.PAPER, 400.0)
    modes = sampled_modes(controller(benchmark, Law.PAPER, 5.0, loop), loop)
    wanted = handlebar_inertia(benchmark, Law.PAPER)
    assert loop.felt_inertia == pytest.approx(wanted)
    mass, damping, stiffness = simulator_matrices(benchmark, Law.PAPER, 5.0, wanted)
    state = np.block(
        [
            [np.zeros((2, 2)), np.eye(2)],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)],
        ]
    )
    for mode in np.linalg.eigvals(state):
        if abs(mode) < 6:  # weave and capsize; castering is too fast for the spring
            assert np.abs(modes - mode).min() < 0.02


@pytest.mark.parametrize("speed", [5.0, 7.0, 10.0])
def test_it_gives_a_light_bar_the_margin_that_it_lacks(benchmark: Bicycle, speed: float):
    """phobos' bar, 0.0427 kg m², 10 ms late: too light by far at 10 m/s, and good with it."""
    bare = SampledLoop(0.0427, 0.001, 0.010)
    coupled = with_coupling(bare, 1.0, benchmark, Law.PAPER)
    without, with_it = (margin_at(benchmark, Law.PAPER, speed, one) for one in (bare, coupled))
    assert not without.is_there
    assert with_it.is_there
    assert with_it.delay_margin > without.delay_margin + 0.01
    assert with_it.error < 0.25 * without.error


def test_a_state_is_all_that_it_knows(benchmark: Bicycle):
    coupled = CoupledBicycle(benchmark, Law.PAPER, COUPLING)
    state = coupled.start(roll=0.05, speed=5.0)
    for k in range(1, 50):
        state = coupled.step(state, 0.001 * k, 0.01 * np.sin(k), 0.0, 5.0)
    again = CoupledBicycle(benchmark, Law.PAPER, COUPLING)
    assert again.step(state, 0.05, 0.1, 0.2, 5.0) == coupled.step(state, 0.05, 0.1, 0.2, 5.0)


def test_many_rigs_at_once_move_as_one_alone(benchmark: Bicycle):
    coupled = CoupledBicycle(benchmark, Law.MOMENTUM, COUPLING)
    speed = np.array([3.0, 5.0])
    many = coupled.start(roll=np.array([0.05, 0.02]), speed=speed)
    one = coupled.start(roll=0.02, speed=5.0)
    for k in range(1, 30):
        many = coupled.step(many, 0.001 * k, np.array([0.1, 0.01 * k]), np.zeros(2), speed)
        one = coupled.step(one, 0.001 * k, 0.01 * k, 0.0, 5.0)
    assert many.feedback_torque[1] == pytest.approx(one.feedback_torque, rel=1e-12)


def test_it_takes_no_inertia_away():
    with pytest.raises(InputError, match="adds inertia and takes none away"):
        virtual_coupling(0.5, inertia=0.3, wanted=0.2311, delay=0.002, period=0.001)


def test_none_is_none():
    assert virtual_coupling(0.0, inertia=0.3, wanted=0.2, delay=0.0, period=0.001) is None


def test_a_longer_delay_asks_for_a_softer_one():
    def of(delay: float) -> Coupling:
        found = virtual_coupling(1.0, inertia=0.05, wanted=0.2311, delay=delay, period=0.001)
        assert found is not None
        return found

    assert of(0.02).stiffness < of(0.005).stiffness
    assert of(0.02).inertia == of(0.005).inertia == pytest.approx(0.1811)


def test_the_loop_keeps_its_other_figures(benchmark: Bicycle):
    bare = SampledLoop(0.05, 0.002, 0.003, motor_lag=0.001)
    assert replace(with_coupling(bare, 0.5, benchmark, Law.PAPER), coupling=None) == bare
