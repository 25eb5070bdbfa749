import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import bicycle_modes, simulator_modes
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia, simulator_mass_matrix, simulator_matrices

SPEEDS = np.linspace(0, 10, 41)


def by_place(values) -> np.ndarray:
    return np.array(sorted(values, key=lambda s: (round(s.real, 6), s.imag)))


def momentum_realisation(bicycle: Bicycle, speed: float, inertia: float) -> np.ndarray:
    """The momentum law and a free bar, written out on (φ, p, δ, δ̇) as SCIENCE states them."""
    m = bicycle.matrices
    C, K = speed * m.C1, bicycle.gravity * m.K0 + speed**2 * m.K2
    roll, momentum, steer, steer_rate = np.eye(4)
    roll_rate = (momentum - m.M[0, 1] * steer_rate) / m.M[0, 0]
    p_dot = -(C[0, 0] * roll_rate + C[0, 1] * steer_rate + K[0, 0] * roll + K[0, 1] * steer)
    torque = -(
        m.M[1, 0] / m.M[0, 0] * p_dot
        + C[1, 0] * roll_rate + C[1, 1] * steer_rate + K[1, 0] * roll + K[1, 1] * steer
    )  # fmt: skip
    return np.array([roll_rate, p_dot, steer_rate, torque / inertia])


def paper_realisation(bicycle: Bicycle, speed: float, inertia: float) -> np.ndarray:
    """Eq. 4, 5 and 6, nobody at the bar, on (φ, φ̇, δ, δ̇)."""
    m = bicycle.matrices
    C, K = speed * m.C1, bicycle.gravity * m.K0 + speed**2 * m.K2
    roll, roll_rate, steer, steer_rate = np.eye(4)
    acceleration = (
        -(C[0, 0] * roll_rate + C[0, 1] * steer_rate + K[0, 0] * roll + K[0, 1] * steer) / m.M[0, 0]
    )
    torque = -(
        m.M[1, 0] * acceleration
        + C[1, 0] * roll_rate + C[1, 1] * steer_rate + K[1, 0] * roll + K[1, 1] * steer
    )  # fmt: skip
    return np.array([roll_rate, acceleration, steer_rate, torque / inertia])


class TestInertia:
    def test_of_the_paper_is_the_smaller_eigenvalue_of_m(self, benchmark: Bicycle):
        """[SR13, Table 1]."""
        assert handlebar_inertia(benchmark, Law.PAPER) == pytest.approx(0.23108501173, abs=1e-11)

    def test_of_the_momentum_law(self, benchmark: Bicycle):
        assert handlebar_inertia(benchmark, Law.MOMENTUM) == pytest.approx(0.2312758932, abs=1e-10)

    def test_with_haptics_off_the_bar_stays_the_same(self, benchmark: Bicycle):
        assert handlebar_inertia(benchmark, Law.OFF) == handlebar_inertia(benchmark, Law.PAPER)

    @pytest.mark.parametrize("name", bicycles.names())
    def test_of_the_momentum_law_keeps_the_determinant_of_m(self, name: str):
        bicycle = bicycles.load(name)
        M = bicycle.matrices.M
        inertia = handlebar_inertia(bicycle, Law.MOMENTUM)
        assert M[0, 0] * inertia == pytest.approx(np.linalg.det(M), rel=1e-12)


class TestMassMatrix:
    def test_eigenvectors_of_the_papers(self, benchmark: Bicycle):
        """[SR13, Table 1], sign corrected: the first is that of M, the second (0, 1)."""
        inertia = handlebar_inertia(benchmark, Law.PAPER)
        mass = simulator_mass_matrix(benchmark, Law.PAPER, inertia)
        assert mass @ [0, 1] == pytest.approx([0, inertia])
        first = np.array([0.999586, 0.028770])
        assert mass @ first == pytest.approx(mass[0, 0] * first, abs=1e-4)

    def test_of_the_momentum_law_is_that_of_the_bicycle(self, benchmark: Bicycle):
        inertia = handlebar_inertia(benchmark, Law.MOMENTUM)
        mass = simulator_mass_matrix(benchmark, Law.MOMENTUM, inertia)
        assert mass == pytest.approx(benchmark.matrices.M, abs=1e-15)

    def test_with_haptics_off_nothing_reaches_the_bar(self, benchmark: Bicycle):
        mass, damping, stiffness = simulator_matrices(benchmark, Law.OFF, 3.5)
        assert not damping[1].any()
        assert not stiffness[1].any()
        assert mass[1].tolist() == [0, handlebar_inertia(benchmark, Law.OFF)]


class TestModes:
    @pytest.mark.parametrize("name", bicycles.names())
    def test_of_the_momentum_law_are_those_of_the_bicycle(self, name: str):
        bicycle = bicycles.load(name)
        for speed in SPEEDS:
            ours = np.array(simulator_modes(bicycle, Law.MOMENTUM, speed).all())
            theirs = np.array(bicycle_modes(bicycle, speed).all())
            assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()

    @pytest.mark.parametrize("name", bicycles.names())
    def test_of_the_momentum_law_as_coded_with_p_are_those_of_the_bicycle(self, name: str):
        bicycle = bicycles.load(name)
        inertia = handlebar_inertia(bicycle, Law.MOMENTUM)
        for speed in SPEEDS:
            ours = by_place(np.linalg.eigvals(momentum_realisation(bicycle, speed, inertia)))
            theirs = by_place(bicycle_modes(bicycle, speed).all())
            assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()

    def test_of_the_momentum_law_with_roll_damping(self, damped_roll: Bicycle):
        inertia = handlebar_inertia(damped_roll, Law.MOMENTUM)
        for speed in SPEEDS:
            ours = by_place(np.linalg.eigvals(momentum_realisation(damped_roll, speed, inertia)))
            theirs = by_place(bicycle_modes(damped_roll, speed).all())
            assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()

    @pytest.mark.parametrize("inertia", [0.0427, 0.2311, 0.3])
    @pytest.mark.parametrize(
        ("law", "realisation"),
        [(Law.MOMENTUM, momentum_realisation), (Law.PAPER, paper_realisation)],
    )
    def test_of_any_inertia_are_those_of_law_and_bar(
        self, benchmark: Bicycle, law: Law, realisation, inertia: float
    ):
        for speed in (1.0, 3.5, 5.0, 10.0):
            ours = by_place(simulator_modes(benchmark, law, speed, inertia).all())
            theirs = by_place(np.linalg.eigvals(realisation(benchmark, speed, inertia)))
            assert ours == pytest.approx(theirs, abs=1e-10)

    def test_of_the_papers_law_are_as_near_as_it_says(self, benchmark: Bicycle):
        """Over 1 to 10 m/s: weave within 0.276 (real part 0.037), capsize 0.020, castering 1.10."""
        weave = real = capsize = castering = 0.0
        for speed in np.linspace(1, 10, 181):
            ours = simulator_modes(benchmark, Law.PAPER, speed)
            theirs = bicycle_modes(benchmark, speed)
            weave = max(weave, abs(ours.weave[0] - theirs.weave[0]))
            real = max(real, abs(ours.weave[0].real - theirs.weave[0].real))
            capsize = max(capsize, abs(ours.capsize - theirs.capsize))
            castering = max(castering, abs(ours.castering - theirs.castering))
        assert weave == pytest.approx(0.276, abs=5e-4)
        assert real == pytest.approx(0.037, abs=5e-4)
        assert capsize == pytest.approx(0.020, abs=5e-4)
        assert castering == pytest.approx(1.10, abs=5e-3)
