import math

import numpy as np
import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.margins import (
    ALLOWED_EXCESS,
    GRIPS,
    continuous_modes,
    critical_delay,
    inertia_error,
    margin_at,
    sampled_modes,
)
from bikesim.model.sampled_loop import RELEASED, Grip, SampledLoop, controller, with_coupling

# Speed [m/s] and pure delay that the loop survives hands off [ms]; SCIENCE, Sec. 5.
PUBLISHED = [
    (0.2311, 3.5, 161), (0.2311, 5.0, 93), (0.2311, 7.0, 61), (0.2311, 10.0, 41),
    (0.0427, 3.5, 27), (0.0427, 5.0, 18), (0.0427, 7.0, 13), (0.0427, 10.0, 9),
]  # fmt: skip
PHOBOS = SampledLoop(0.0427, 0.001, 0.013, motor_lag=0.004)


@pytest.mark.parametrize(("inertia", "speed", "milliseconds"), PUBLISHED)
def test_the_pure_delay_that_the_loop_survives(
    benchmark: Bicycle, inertia: float, speed: float, milliseconds: int
):
    delay, _ = critical_delay(benchmark, Law.PAPER, speed, SampledLoop(inertia, 1e-4))
    assert 1e3 * delay == pytest.approx(milliseconds, abs=0.7)


@pytest.mark.parametrize("speed", [3.5, 5.0, 7.0, 10.0])
@pytest.mark.parametrize(
    "loop",
    [
        SampledLoop(0.2311, 0.005),
        SampledLoop(0.1, 0.002, motor_lag=0.005, viscous_friction=0.1),
        SampledLoop(0.1, 0.002, filter_cutoff=100.0),
        SampledLoop(0.2, 0.002, sensor_interval=0.01),
    ],
    ids=["plain", "lag", "filter", "slow sensor"],
)
def test_there_a_mode_becomes_unstable(benchmark: Bicycle, loop: SampledLoop, speed: float):
    """By the eigenvalues of the loop with a little less and a little more delay."""
    from dataclasses import replace

    critical, frequency = critical_delay(benchmark, Law.PAPER, speed, loop)
    counts = []
    for delay in (critical - 0.002, critical + 0.002):
        with_it = replace(loop, delay=delay)
        modes = sampled_modes(controller(benchmark, Law.PAPER, speed, with_it), with_it)
        counts.append(int(np.sum(modes.real > 1e-6)))
        assert np.abs(modes - 1j * frequency).min() < 0.1 * frequency
    assert counts[1] == counts[0] + 2


def test_of_the_loops_own_delay_only_what_is_left_counts(benchmark: Bicycle):
    none, some = (
        margin_at(benchmark, Law.PAPER, 5.0, SampledLoop(0.2311, 0.001, delay), [RELEASED])
        for delay in (0.0, 0.02)
    )
    assert none.delay_margin - some.delay_margin == pytest.approx(0.02)


def test_a_light_and_late_rig_has_its_limit_cycle_at_7_m_s_and_none_at_5(benchmark: Bicycle):
    """phobos: about 20 ms of lag, 14 Hz; SCIENCE, Sec. 5."""
    five, seven = (margin_at(benchmark, Law.PAPER, v, PHOBOS, [RELEASED]) for v in (5.0, 7.0))
    assert five.is_there
    assert five.delay_margin > 0
    assert not seven.is_there
    assert seven.delay_margin < 0
    assert seven.mode.imag / (2 * math.pi) == pytest.approx(14, abs=1)


def test_so_it_has_with_20_ms_of_pure_delay(benchmark: Bicycle):
    loop = SampledLoop(0.0427, 0.001, 0.020)
    seven = margin_at(benchmark, Law.PAPER, 7.0, loop, [RELEASED])
    assert seven.excess > 10
    assert seven.mode.imag / (2 * math.pi) == pytest.approx(14, abs=1)


@pytest.mark.parametrize("speed", [0.0, 1.0, 3.5, 5.0, 7.0, 10.0])
@pytest.mark.parametrize("period", [0.001, 0.005])
def test_with_the_inertia_asked_for_no_grip_makes_sampling_matter(
    benchmark: Bicycle, period: float, speed: float
):
    """At most 5 ms and two periods of delay, to 10 m/s; SCIENCE, Sec. 5."""
    margin = margin_at(benchmark, Law.PAPER, speed, SampledLoop(0.2311, period, 2 * period))
    assert margin.excess < ALLOWED_EXCESS
    assert margin.is_there


def test_the_grips_go_from_released_to_tight():
    assert GRIPS[0] == RELEASED
    assert [max(figure) for figure in zip(*GRIPS, strict=True)] == [0.5, 10.0, 500.0]


def test_a_grip_can_be_what_has_no_margin(benchmark: Bicycle):
    """Stiff arms without damping on a light bar 13 ms late: they oscillate on the motor."""
    margin = margin_at(benchmark, Law.PAPER, 3.5, PHOBOS)
    assert margin.delay_margin > 0
    assert not margin.is_there
    assert margin.grip.stiffness == 500
    assert margin.grip.damping == 0


def test_a_new_instability_does_not_hide_behind_a_faster_fall(benchmark: Bicycle):
    """At 2 m/s the bicycle falls by itself, faster than this loop's new mode grows."""
    loop = SampledLoop(0.0427, 0.001, 0.0515)
    continuous = continuous_modes(benchmark, Law.PAPER, 2.0, loop)
    sampled = sampled_modes(controller(benchmark, Law.PAPER, 2.0, loop), loop)
    assert sampled[0].real < continuous[0].real + ALLOWED_EXCESS
    margin = margin_at(benchmark, Law.PAPER, 2.0, loop, [RELEASED])
    assert not margin.is_there
    assert margin.mode.imag > 20


def test_a_short_period_without_delay_is_the_continuous_loop(benchmark: Bicycle):
    margin = margin_at(benchmark, Law.MOMENTUM, 5.0, SampledLoop(0.2312758932, 1e-4))
    assert abs(margin.excess) < 0.01
    assert margin.error < 0.01
    assert margin.inertia_error < 1e-9


@pytest.mark.parametrize(("speed", "error"), [(3.5, 0.036), (10.0, 0.276)])
def test_the_error_that_an_inertia_makes(benchmark: Bicycle, speed: float, error: float):
    """I = λ2; SCIENCE, Sec. 2."""
    assert inertia_error(benchmark, Law.PAPER, speed, 0.23108501173) == pytest.approx(
        error, abs=1e-3
    )


def test_haptics_off_has_no_loop_to_become_unstable(benchmark: Bicycle):
    margin = margin_at(benchmark, Law.OFF, 5.0, SampledLoop(0.2311, 0.005, 0.01))
    assert margin.delay_margin == math.inf
    assert margin.excess == pytest.approx(0, abs=1e-6)
    assert margin.is_there


@pytest.mark.parametrize("share", [0.0, 0.5])
@pytest.mark.parametrize("scale", [1.0, 0.4, 0.0])
def test_a_scaled_loop_that_is_fast_is_nearly_continuous(
    benchmark: Bicycle, share: float, scale: float
):
    """Matrices against the code that runs; of a coupling, one with hardly any give."""
    loop = SampledLoop(0.1, 1e-4, viscous_friction=0.2, scale=scale)
    if share:
        loop = with_coupling(loop, share, benchmark, Law.PAPER, 2000.0)
    grip = Grip(0.05, 0.4, 8.0)
    sampled = sampled_modes(controller(benchmark, Law.PAPER, 4.0, loop), loop, grip)
    for mode in continuous_modes(benchmark, Law.PAPER, 4.0, loop, grip):
        assert np.abs(sampled - mode).min() < 0.05
