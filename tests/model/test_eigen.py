import math
from collections.abc import Callable
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigvals
from scipy.optimize import brentq, linear_sum_assignment

from bikesim import bicycles
from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import (
    Modes,
    bicycle_modes,
    eigenvalues,
    name_modes,
    simulator_modes,
    stability_limits,
)
from bikesim.model.law import Law

# [M07, Table 2]: speed, castering, capsize, weave (real, imaginary).
PUBLISHED = [
    (1, -7.11008014637442, -3.13423125066578, 3.52696170990070, 0.80774027519930),
    (3, -10.35101467245920, -2.63366137253667, 1.70675605663975, 2.31582447384325),
    (5, -14.07838969279822, -0.32286642900409, -0.77534188219585, 4.46486771378823),
    (7, -18.15788466125262, 0.10268170574766, -2.13875644258362, 7.19525913329805),
    (10, -24.62459635017404, 0.16105338653172, -3.72016840437287, 10.90681139476287),
]
# [M07, Sec. 4]: the speed where the two unstable real roots meet, and the root there.
DOUBLE_ROOT_SPEED, DOUBLE_ROOT = 0.684283078892460, 3.78290405129320
WEAVE_SPEED, CAPSIZE_SPEED = 4.29238253634111, 6.02426201538837
SPEEDS = np.linspace(0, 10, 1001)

Modal = Callable[[Bicycle, float], Modes]


def paper_modes(bicycle: Bicycle, speed: float) -> Modes:
    return simulator_modes(bicycle, Law.PAPER, speed)


def quadratic_eigenvalues(bicycle: Bicycle, speed: float) -> np.ndarray:
    """An independent way: the generalised problem A x = s B x, by scipy's QZ."""
    m = bicycle.matrices
    C, K = speed * m.C1, bicycle.gravity * m.K0 + speed**2 * m.K2
    zero, one = np.zeros((2, 2)), np.eye(2)
    A, B = np.block([[zero, one], [-K, -C]]), np.block([[one, zero], [zero, m.M]])
    return np.asarray(eigvals(A, B))


class TestPublished:
    @pytest.mark.parametrize("row", PUBLISHED, ids=lambda row: f"{row[0]} m/s")
    def test_eigenvalues_of_the_benchmark(self, benchmark: Bicycle, row: tuple[float, ...]):
        speed, castering, capsize, real, imag = row
        modes = bicycle_modes(benchmark, speed)
        assert abs(modes.castering - castering) <= 1e-12
        assert abs(modes.capsize - capsize) <= 1e-12
        assert abs(modes.weave[0] - complex(real, imag)) <= 1e-12
        assert abs(modes.weave[1] - complex(real, -imag)) <= 1e-12

    def test_at_rest(self, benchmark: Bicycle):
        modes = bicycle_modes(benchmark, 0.0)
        assert modes.castering == pytest.approx(-5.53094371765393, abs=1e-12)
        assert modes.capsize == pytest.approx(-3.13164324790656, abs=1e-12)
        assert modes.weave[0] == pytest.approx(3.13164324790656, abs=1e-12)
        assert modes.weave[1] == pytest.approx(5.53094371765393, abs=1e-12)

    def test_simulator_at_3_5_m_s(self, benchmark: Bicycle):
        """[SR13, eq. 7] with I = λ2."""
        modes = simulator_modes(benchmark, Law.PAPER, 3.5)
        assert modes.weave[0] == pytest.approx(1.1367 + 2.6705j, abs=1e-4)
        assert modes.capsize == pytest.approx(-2.1632, abs=5e-5)
        assert modes.castering == pytest.approx(-10.9161, abs=5e-5)

    def test_bicycle_at_3_5_m_s(self, benchmark: Bicycle):
        modes = bicycle_modes(benchmark, 3.5)
        assert modes.weave[0] == pytest.approx(1.1113 + 2.6441j, abs=1e-4)
        assert modes.capsize == pytest.approx(-2.1496, abs=5e-5)
        assert modes.castering == pytest.approx(-11.2393, abs=5e-5)


class TestEigenvalues:
    @pytest.mark.parametrize("name", bicycles.names())
    @pytest.mark.parametrize("speed", [0.0, 0.3, 4.0, 9.7])
    def test_as_scipy_finds_them(self, name: str, speed: float):
        bicycle = bicycles.load(name)
        ours = np.array(bicycle_modes(bicycle, speed).all())
        theirs = quadratic_eigenvalues(bicycle, speed)
        assert np.abs(ours[:, None] - theirs[None, :]).min(axis=1).max() < 1e-11
        assert np.abs(ours[:, None] - theirs[None, :]).min(axis=0).max() < 1e-11

    def test_of_a_mass_matrix_that_is_not_symmetric(self):
        mass, damping, stiffness = np.random.default_rng(1).normal(size=(3, 2, 2))
        for s in eigenvalues(mass, damping, stiffness):
            assert abs(np.linalg.det(s**2 * mass + s * damping + stiffness)) < 1e-10

    def test_without_gravity_at_rest_all_four_are_zero(self, benchmark: Bicycle):
        modes = bicycle_modes(benchmark.with_gravity(0.0), 0.0)
        assert modes.all() == (0, 0, 0, 0)

    def test_without_gravity_the_capsize_is_zero(self, benchmark: Bicycle):
        modes = bicycle_modes(benchmark.with_gravity(0.0), 4.0)
        assert abs(modes.capsize) < 1e-12
        assert modes.weave[0].imag > 0
        assert modes.castering.real < -1


class TestNames:
    def test_do_not_depend_on_the_order(self):
        values = [-14.1 + 0j, -0.3 + 0j, -0.8 + 4.5j, -0.8 - 4.5j]
        expected = Modes(-14.1, -0.3, (-0.8 + 4.5j, -0.8 - 4.5j))
        assert {name_modes(np.array(order)) for order in permutations(values)} == {expected}

    def test_capsize_is_the_less_stable_real_one_also_when_unstable(self):
        modes = name_modes(np.array([0.1 + 0j, -18, -2 + 7j, -2 - 7j]))
        assert (modes.castering, modes.capsize) == (-18, 0.1)

    def test_of_two_pairs_the_weave_is_the_less_stable(self):
        modes = name_modes(np.array([-5 + 1j, -5 - 1j, -1 + 9j, -1 - 9j]))
        assert modes.weave == (-1 + 9j, -1 - 9j)
        assert {modes.castering, modes.capsize} == {-5 + 1j, -5 - 1j}

    def test_at_the_double_root(self, benchmark: Bicycle):
        modes = bicycle_modes(benchmark, DOUBLE_ROOT_SPEED)
        # A double root's rounding error is the square root of that of a simple one.
        assert modes.weave[0] == pytest.approx(DOUBLE_ROOT, abs=1e-6)
        assert modes.weave[1] == pytest.approx(DOUBLE_ROOT, abs=1e-6)
        assert modes.castering.real < modes.capsize.real < 0

    @pytest.mark.parametrize("offset", [-1e-3, -1e-9, 0, 1e-9, 1e-3])
    def test_around_the_double_root_stay(self, benchmark: Bicycle, offset: float):
        there = bicycle_modes(benchmark, DOUBLE_ROOT_SPEED)
        modes = bicycle_modes(benchmark, DOUBLE_ROOT_SPEED + offset)
        assert modes.castering == pytest.approx(there.castering, abs=0.01)
        assert modes.capsize == pytest.approx(there.capsize, abs=0.01)

    def test_through_the_capsize_zero(self, benchmark: Bicycle):
        before, at, after = (
            bicycle_modes(benchmark, CAPSIZE_SPEED + offset) for offset in (-0.01, 0, 0.01)
        )
        assert before.capsize.real < 0 < after.capsize.real
        assert abs(at.capsize) < 1e-12
        assert at.weave[0].imag > 5

    @pytest.mark.parametrize("name", bicycles.names())
    def test_are_continuous_in_speed(self, name: str):
        _assert_continuous([bicycle_modes(bicycles.load(name), v) for v in SPEEDS])

    @pytest.mark.parametrize("rig", [bicycle_modes, paper_modes])
    def test_are_continuous_where_castering_and_capsize_meet(self, rig: Modal, shared: Path):
        """The Browser without a rider: two stable roots become a pair beside two unstable ones."""
        path = shared / "reference" / "bicycles" / "BrowserBenchmark.txt"
        bicycle = bicycles.load(path)
        found = [rig(bicycle, v) for v in SPEEDS]
        _assert_continuous(found)
        assert any(modes.castering.imag != 0 for modes in found)
        assert all(modes.weave[0].real > 2 for modes in found[:100])


def _assert_continuous(found: list[Modes]) -> None:
    """The names carry over from speed to speed as the nearest pairing of the roots does."""
    for before, after in pairwise([np.array(modes.all()) for modes in found]):
        distance = np.abs(before[:, None] - after[None, :])
        nearest = distance[linear_sum_assignment(distance)].sum()
        # The two of one pair may change places where they meet.
        orders = ([0, 1, 2, 3], [0, 1, 3, 2], [1, 0, 2, 3], [1, 0, 3, 2])
        kept = min(distance[[0, 1, 2, 3], order].sum() for order in orders)
        assert kept == pytest.approx(nearest, abs=1e-12)


class TestStabilityLimits:
    def test_of_the_bicycle(self, benchmark: Bicycle):
        limits = stability_limits(benchmark)
        assert limits.weave == pytest.approx(WEAVE_SPEED, abs=1e-12)
        assert limits.capsize == pytest.approx(CAPSIZE_SPEED, abs=1e-12)

    @pytest.mark.parametrize(
        ("inertia", "weave"), [(None, 4.30097182174), (0.3, 4.51083841507)], ids=str
    )
    def test_of_the_simulator(self, benchmark: Bicycle, inertia: float | None, weave: float):
        limits = stability_limits(benchmark, Law.PAPER, inertia)
        assert limits.weave == pytest.approx(weave, abs=1e-10)
        assert limits.capsize == pytest.approx(CAPSIZE_SPEED, abs=1e-12)

    def test_under_the_momentum_law_are_those_of_the_bicycle(self, benchmark: Bicycle):
        limits = stability_limits(benchmark, Law.MOMENTUM)
        assert limits == pytest.approx((WEAVE_SPEED, CAPSIZE_SPEED), abs=1e-12)

    def test_with_haptics_off_there_are_none(self, benchmark: Bicycle):
        assert stability_limits(benchmark, Law.OFF) == (None, None)

    def test_the_weave_frequency_there(self, benchmark: Bicycle):
        """[M07]: at the weave speed the eigenvalue is ±3.43503384866144i."""
        weave = bicycle_modes(benchmark, WEAVE_SPEED).weave[0]
        assert weave == pytest.approx(3.43503384866144j, abs=1e-12)

    @pytest.mark.parametrize("name", bicycles.names())
    def test_as_root_finding_on_scipys_eigenvalues(self, name: str):
        bicycle = bicycles.load(name)

        def weave(speed: float) -> float:
            return max(s.real for s in quadratic_eigenvalues(bicycle, speed) if s.imag > 1e-3)

        def capsize(speed: float) -> float:
            return max(s.real for s in quadratic_eigenvalues(bicycle, speed) if abs(s.imag) < 1e-9)

        limits = stability_limits(bicycle)
        assert limits.weave == pytest.approx(brentq(weave, 3, 8), abs=1e-9)
        assert limits.capsize == pytest.approx(brentq(capsize, 5.9, 12), abs=1e-9)

    @pytest.mark.parametrize("gravity", [0.0, 1.62])
    def test_scale_with_the_root_of_gravity(self, benchmark: Bicycle, gravity: float):
        """K = g K0 + v² K2: speeds go with √g; without gravity no real eigenvalue passes zero."""
        limits = stability_limits(benchmark.with_gravity(gravity))
        if gravity == 0:
            assert limits.capsize is None
            return
        scale = math.sqrt(gravity / 9.81)
        assert limits == pytest.approx((scale * WEAVE_SPEED, scale * CAPSIZE_SPEED), rel=1e-12)
