import numpy as np
import pytest
from scipy.linalg import expm

from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import simulator_modes
from bikesim.model.law import Law
from bikesim.model.sampled import sampled_eigenvalues
from bikesim.model.simulator import handlebar_inertia, simulator_matrices


def weave(values: np.ndarray) -> complex:
    """Of eigenvalues in order of stability, the least stable pair's upper half."""
    return next(s for s in values if s.imag > 1e-6)


def papers_loop(bicycle: Bicycle, speed: float, period: float, inertia: float) -> np.ndarray:
    """One period of eq. 4 and 6 without delay on (φ, φ̇, δ, δ̇), from scipy's exponentials."""
    m = bicycle.matrices
    C, K = m.damping(speed), m.stiffness(speed, bicycle.gravity)
    eye = np.eye(4)
    # The bar under the torque that follows from the state at the tick, held.
    acceleration = -(C[0] @ eye[[1, 3]] + K[0] @ eye[[0, 2]]) / m.M[0, 0]
    torque = -(m.M[1, 0] * acceleration + C[1] @ eye[[1, 3]] + K[1] @ eye[[0, 2]])
    bar = eye[2:] + period * np.array([eye[3], 0 * torque])
    bar += np.outer([period**2 / 2, period], torque) / inertia
    # The roll under steer and rate that go straight from one tick's to the next's.
    generator = np.zeros((6, 6))
    generator[0, 1] = 1
    generator[1, :4] = [-K[0, 0], -C[0, 0], -K[0, 1], -C[0, 1]]
    generator[1] /= m.M[0, 0]
    generator[2:4, 4:] = np.eye(2) / period
    moved = expm(generator * period)[:2]
    roll = moved[:, :4] + moved[:, 4:] @ (bar - eye[2:])
    return np.vstack([roll, bar])


@pytest.mark.parametrize(
    ("period", "published"),
    [(1e-3, -0.773 + 4.561j), (5e-3, -0.783 + 4.592j), (10e-3, -0.798 + 4.631j)],
)
def test_one_period_of_delay_at_5_m_s(benchmark: Bicycle, period: float, published: complex):
    """The weave of the sampled loop; SCIENCE, Sec. 5."""
    values = sampled_eigenvalues(benchmark, Law.PAPER, 5.0, period=period, delay_periods=1)
    found = weave(values)
    assert (found.real, found.imag) == pytest.approx((published.real, published.imag), abs=6e-4)


@pytest.mark.parametrize("law", [Law.PAPER, Law.MOMENTUM])
@pytest.mark.parametrize("speed", [1.0, 3.5, 7.0])
def test_a_short_period_is_the_continuous_loop(benchmark: Bicycle, law: Law, speed: float):
    values = sampled_eigenvalues(benchmark, law, speed, period=1e-5)
    for mode in simulator_modes(benchmark, law, speed).all():
        assert np.abs(values - mode).min() < 1e-2 * max(1, abs(mode))


@pytest.mark.parametrize("speed", [0.0, 3.5, 8.0])
@pytest.mark.parametrize("period", [1e-3, 5e-3, 20e-3])
def test_without_delay_are_those_of_scipys_exponential(
    benchmark: Bicycle, speed: float, period: float
):
    inertia = handlebar_inertia(benchmark, Law.PAPER)
    ours = np.exp(period * sampled_eigenvalues(benchmark, Law.PAPER, speed, period=period))
    theirs = np.linalg.eigvals(papers_loop(benchmark, speed, period, inertia))
    assert len(ours) == 4
    assert np.abs(ours[:, None] - theirs[None, :]).min(axis=1).max() < 1e-9
    assert np.abs(ours[:, None] - theirs[None, :]).min(axis=0).max() < 1e-9


@pytest.mark.parametrize("delay", [0, 1, 2, 5])
def test_each_period_of_delay_adds_a_mode(benchmark: Bicycle, delay: int):
    values = sampled_eigenvalues(benchmark, Law.PAPER, 5.0, period=5e-3, delay_periods=delay)
    assert len(values) == 4 + delay


def test_the_least_stable_comes_first(benchmark: Bicycle):
    values = sampled_eigenvalues(benchmark, Law.PAPER, 5.0, period=5e-3, delay_periods=2)
    assert np.all(np.diff(np.real(values)) <= 1e-9)


def test_with_haptics_off_the_bicycle_falls_as_a_pendulum(benchmark: Bicycle):
    values = sampled_eigenvalues(benchmark, Law.OFF, 3.5, period=1e-3)
    assert values[0] == pytest.approx(np.sqrt(9.81 * 80.95 / 80.81722), abs=1e-6)


@pytest.mark.parametrize(
    ("inertia", "speed", "milliseconds"), [(0.2311, 5.0, 93), (0.2311, 10.0, 41), (0.0427, 5.0, 18)]
)
def test_the_pure_delay_that_the_loop_survives(
    benchmark: Bicycle, inertia: float, speed: float, milliseconds: int
):
    """Hands off; SCIENCE, Sec. 5. The capsize, unstable when fast, is not meant."""

    def growth(delay: int) -> float:
        values = sampled_eigenvalues(
            benchmark, Law.PAPER, speed, period=1e-3, delay_periods=delay, inertia=inertia
        )
        return weave(values).real

    # The held torque is late by half a period more.
    assert growth(milliseconds - 2) < 0 < growth(milliseconds + 1)


@pytest.mark.parametrize("speed", [3.5, 7.0, 10.0])
@pytest.mark.parametrize(
    "arms", [(0, 0, 0), (0.1, 2, 5), (0.5, 0, 500), (0.5, 10, 0), (0.0, 10, 500)], ids=str
)
def test_no_grip_makes_sampling_matter(
    benchmark: Bicycle, speed: float, arms: tuple[float, float, float]
):
    """The sampled loop is at most 0.5 1/s less stable than the continuous one; SCIENCE, Sec. 5."""
    J, b, k = arms
    inertia = 0.2311 + J
    sampled = sampled_eigenvalues(
        benchmark, Law.PAPER, speed, period=5e-3, delay_periods=2, inertia=inertia,
        arm_damping=b, arm_stiffness=k,
    )  # fmt: skip
    mass, damping, stiffness = simulator_matrices(benchmark, Law.PAPER, speed, inertia)
    held = np.array([[0, 0], [0, 1]])
    state = np.block(
        [
            [np.zeros((2, 2)), np.eye(2)],
            [
                -np.linalg.solve(mass, stiffness + k * held),
                -np.linalg.solve(mass, damping + b * held),
            ],
        ]
    )
    assert sampled[0].real <= np.linalg.eigvals(state).real.max() + 0.5
