"""The loop's matrix against the same loop stepped by other means."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.model.coupling import CoupledBicycle
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.low_pass import LowPass
from bikesim.model.margins import sampled_modes
from bikesim.model.sampled_loop import (
    Grip,
    SampledLoop,
    controller,
    loop_matrix,
    loop_response,
    with_coupling,
)

PLAIN = SampledLoop(0.2, 0.005)
LOOPS = {
    "plain": PLAIN,
    "delay of whole periods": SampledLoop(0.2, 0.005, 0.010),
    "delay of a part": SampledLoop(0.2, 0.005, 0.0065, viscous_friction=0.3),
    "lag": SampledLoop(0.2, 0.005, 0.002, motor_lag=0.01),
    "filter": SampledLoop(0.2, 0.005, 0.0, filter_cutoff=60.0, filter_order=3),
    "slow sensor": SampledLoop(0.2, 0.005, 0.003, sensor_interval=0.02),
    "scaled": SampledLoop(0.2, 0.005, 0.005, scale=0.4),
}


def ridden(bicycle: Bicycle, speed: float, loop: SampledLoop, grip: Grip, time: float) -> list:
    """The released bar from 0.02 rad, its motion by scipy, the loop by the classes that ride."""
    haptic = (
        HapticBicycle(bicycle, Law.PAPER)
        if loop.coupling is None
        else CoupledBicycle(bicycle, Law.PAPER, loop.coupling)
    )
    filters = None
    if loop.filter_cutoff is not None:
        filters = [
            LowPass(loop.filter_cutoff, loop.filter_order, loop.period, "filter") for _ in range(2)
        ]
        for low_pass in filters:
            low_pass(0.0)
    inertia = loop.inertia + grip.inertia
    damping = loop.viscous_friction + grip.damping

    def moved(start: np.ndarray, torque: float, time: float) -> np.ndarray:
        def slope(_, x: np.ndarray) -> list[float]:
            lagged = x[2] if loop.motor_lag else torque
            pull = 0.0 if not loop.motor_lag else (torque - x[2]) / loop.motor_lag
            return [x[1], (lagged - damping * x[1] - grip.stiffness * x[0]) / inertia, pull]

        return solve_ivp(slope, (0, time), start, rtol=1e-10, atol=1e-13).y[:, -1]

    whole = int(loop.delay / loop.period + 1e-9)
    part = loop.delay - whole * loop.period
    bar, held, sent = np.array([0.02, 0.0, 0.0]), np.zeros(2), [0.0] * (whole + 2)
    state = haptic.start(speed=speed)
    rows = []
    for k in range(round(time / loop.period)):
        if k % loop.ticks_per_sample == 0:
            held = bar[:2].copy()
        seen = held if filters is None else [f(x) for f, x in zip(filters, held, strict=True)]
        state = haptic.step(state, (k + 1) * loop.period, float(seen[0]), float(seen[1]), speed)
        sent.append(loop.scale * state.feedback_torque)
        rows.append(bar[0])
        if part > 1e-9:
            bar = moved(bar, sent[-2 - whole], part)
        bar = moved(bar, sent[-1 - whole], loop.period - part)
    return rows


@pytest.mark.parametrize("name", LOOPS)
def test_the_modes_are_those_of_the_loop_as_it_runs(benchmark: Bicycle, name: str):
    """Every ride is a sum of the modes' powers: a linear recurrence that the modes foretell."""
    loop, grip, speed = LOOPS[name], Grip(0.05, 0.4, 8.0), 5.0
    steer = np.array(ridden(benchmark, speed, loop, grip, 0.8))[:: loop.ticks_per_sample]
    modes = sampled_modes(controller(benchmark, Law.PAPER, speed, loop), loop, grip)
    z = np.exp(modes * loop.period * loop.ticks_per_sample)
    recurrence = np.real(np.poly(z))
    order = len(recurrence) - 1
    # Beyond the first samples, in which what has z = 0 (delays) dies out.
    left = np.convolve(steer, recurrence, mode="valid")[5:]
    assert len(left) > 10
    assert np.abs(left).max() < 1e-7 * np.abs(steer).max() * np.abs(recurrence).sum(), order


@pytest.mark.parametrize("scale", [1.0, 0.3])
def test_the_modes_of_a_coupled_loop_too(benchmark: Bicycle, scale: float):
    loop = with_coupling(SampledLoop(0.06, 0.002, 0.003, scale=scale), 0.8, benchmark, Law.PAPER)
    steer = np.array(ridden(benchmark, 5.0, loop, Grip(), 0.3))
    modes = sampled_modes(controller(benchmark, Law.PAPER, 5.0, loop), loop)
    recurrence = np.real(np.poly(np.exp(modes * loop.period)))
    left = np.convolve(steer, recurrence, mode="valid")[5:]
    assert np.abs(left).max() < 1e-7 * np.abs(steer).max() * np.abs(recurrence).sum()


@pytest.mark.parametrize("name", ["plain", "lag", "filter"])
def test_the_response_is_minus_one_at_the_modes(benchmark: Bicycle, name: str):
    """1 + L = 0 where the matrix has its eigenvalues, L continued to complex frequencies."""
    from dataclasses import replace

    loop = replace(LOOPS[name], delay=0.0, viscous_friction=0.0)
    control = controller(benchmark, Law.PAPER, 5.0, loop)
    for mode in sampled_modes(control, loop)[:2]:
        found = loop_response(control, loop, np.array([-1j * mode]))
        assert found[0] == pytest.approx(-1, abs=1e-6)


def test_a_delay_of_nearly_a_period_is_one(benchmark: Bicycle):
    control = controller(benchmark, Law.PAPER, 5.0, PLAIN)
    nearly = loop_matrix(control, SampledLoop(0.2, 0.005, 0.005 * (1 - 1e-12)))
    assert nearly.shape == loop_matrix(control, SampledLoop(0.2, 0.005, 0.005)).shape


def test_a_filter_above_half_the_sampling_frequency(benchmark: Bicycle):
    loop = SampledLoop(0.2, 0.005, filter_cutoff=700.0)
    with pytest.raises(InputError, match=r"below 628\.319 rad/s"):
        controller(benchmark, Law.PAPER, 5.0, loop)
