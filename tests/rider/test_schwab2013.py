from pathlib import Path

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.rider.base import Sight
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS, IdentifiedRider, IdentifiedRun

OMEGA, ZETA = 2 * np.pi * 2.17, 2**-0.5


def test_the_table_is_the_published_one(shared: Path):
    table = np.loadtxt(shared / "reference" / "rider_gains" / "schwab2013.txt", comments="%")
    assert np.array(IDENTIFIED_RUNS).tolist() == table.tolist()


def sight(roll: float, roll_rate: float) -> Sight:
    return Sight(1.0, 3.5, roll, roll_rate, 0.0, 0.0, 0.0, 0.0)


def test_he_sees_roll_and_roll_rate(setting):
    brain = IdentifiedRider(setting(), roll_gain=20.0, roll_rate_gain=30.0)
    assert brain.intend(0.2, 1.0, sight(0.1, 0.01)) == pytest.approx(2.3, rel=1e-12)


def test_he_feels_the_steer_rate(setting):
    brain = IdentifiedRider(setting(), steer_rate_gain=-3.0)
    assert brain.intend(0.2, 0.5, sight(0.1, 0.01)) == pytest.approx(-1.5, rel=1e-12)


@pytest.mark.parametrize("step", [1e-4, 1e-3])
def test_he_integrates_the_steer_in_time_not_in_steps(setting, step: float):
    brain, torque = IdentifiedRider(setting(step=step), steer_integral_gain=60.0), 0.0
    for _ in range(round(0.5 / step)):
        torque = brain.intend(0.1, 0.0, sight(0.0, 0.0))
    assert torque == pytest.approx(60 * 0.1 * 0.5, rel=1e-9)


def closed_loop(run: IdentifiedRun, matrices: tuple[np.ndarray, ...]) -> np.ndarray:
    """Eigenvalues of rider and bicycle together, on (φ, δ, φ̇, δ̇, ∫δ, T, Ṫ)."""
    mass, damping, stiffness = matrices
    A = np.zeros((7, 7))
    A[5:, 5:] = [[0, 1], [-(OMEGA**2), -2 * ZETA * OMEGA]]
    A[:2, 2:4] = np.eye(2)
    A[2:4, :4] = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    A[2:4, 5] = np.linalg.solve(mass, [0, 1])
    A[4, 1] = 1
    A[6, [0, 2, 4, 3]] = OMEGA**2 * np.array(run[2:6])
    return np.linalg.eigvals(A)


def test_run_184_has_the_modes_that_are_known():
    """SCIENCE, Sec. 3, on the bicycle, with haptics on and off."""
    davis, run = bicycles.load("davis"), next(run for run in IDENTIFIED_RUNS if run.run == 184)
    m = davis.matrices
    on_bicycle = closed_loop(
        run, (m.M, m.damping(run.speed), m.stiffness(run.speed, davis.gravity))
    )
    on, off = (
        closed_loop(run, simulator_matrices(davis, law, run.speed)) for law in (Law.PAPER, Law.OFF)
    )
    for values, known in (
        (on_bicycle, [-0.781 + 2.505j, -1.484 + 4.933j, -1.958 + 11.806j]),
        (on, [-0.746 + 2.439j, -1.785 + 5.852j, -2.197 + 10.406j]),
        (off, [3.830 + 11.142j]),
    ):
        for mode in known:
            assert np.abs(values - mode).min() < 1.5e-3


@pytest.mark.parametrize("run", IDENTIFIED_RUNS, ids=lambda run: str(run.run))
def test_each_is_stable_with_haptics_and_unstable_without(run: IdentifiedRun):
    """Growth without: 2.99 to 7.36 1/s; SCIENCE, Sec. 3."""
    davis = bicycles.load("davis")
    on, off = (
        np.real(closed_loop(run, simulator_matrices(davis, law, run.speed))).max()
        for law in (Law.PAPER, Law.OFF)
    )
    assert on < 0
    assert 2.985 < off < 7.365
