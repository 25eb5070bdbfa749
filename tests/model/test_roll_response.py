import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.model.roll_response import Bar, roll_response
from bikesim.model.simulator import handlebar_inertia, simulator_matrices

FREQUENCIES = np.geomspace(0.1, 60, 20)
ONE = np.ones(len(FREQUENCIES), complex)


@pytest.mark.parametrize("law", list(Law))
@pytest.mark.parametrize("speed", [2.0, 5.0])
def test_it_is_that_of_the_simulators_matrices_with_arms(law: Law, speed: float):
    """[SR13, eq. 7] solved at each frequency, the arms on the bar."""
    bicycle = bicycles.load("benchmark")
    inertia, damping, stiffness = 0.1, 2.0, 5.0
    M, C, K = simulator_matrices(bicycle, law, speed)
    on_bar = np.diag([0.0, 1.0])
    expected = [
        np.linalg.solve(
            -(w**2) * (M + inertia * on_bar) + 1j * w * (C + damping * on_bar) + K
            + stiffness * on_bar,
            [0, 1],
        )[0]
        for w in FREQUENCIES
    ]  # fmt: skip
    bar = Bar(handlebar_inertia(bicycle, law) + inertia, damping, stiffness, ONE, ONE)
    found = roll_response(bicycle, law, speed, bar, FREQUENCIES)
    assert np.allclose(found, expected, rtol=1e-10)


def test_no_feedback_is_haptics_off():
    bicycle = bicycles.load("benchmark")
    bar = Bar(0.3, 1.0, 0.0, ONE, 0 * ONE)
    on, off = (roll_response(bicycle, law, 4.0, bar, FREQUENCIES) for law in (Law.PAPER, Law.OFF))
    assert np.allclose(on, off)
