"""Table 1 of the paper."""

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.report.paper.table1 import eigenvectors, table1

BENCHMARK = bicycles.load("benchmark")
CLAIMS = table1(BENCHMARK)


def test_the_eigenvalues_are_the_printed_ones():
    larger, smaller = CLAIMS[:2]
    assert larger.ours == pytest.approx(80.88397687, abs=5e-9)
    assert smaller.ours == pytest.approx(0.23108501173, abs=5e-12)
    assert larger.holds
    assert smaller.holds


def test_the_eigenvectors_are_the_true_pair():
    expected = np.array([[0.999586, -0.028770], [0.028770, 0.999586]])  # SCIENCE.md section 2
    np.testing.assert_allclose(eigenvectors(BENCHMARK.matrices.M), expected, atol=5e-7)


def test_the_printed_eigenvectors_do_not_hold():
    claim = CLAIMS[2]
    assert not claim.holds
    assert "0.0575" in claim.note


@pytest.mark.parametrize("place", [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_one_sign_wrong_anywhere_is_no_pair_of_eigenvectors(place: tuple[int, int]):
    """What the note says, from the printed digits alone."""
    M = BENCHMARK.matrices.M
    pair = np.array([[0.999586, -0.028770], [0.028770, 0.999586]])
    pair[place] *= -1
    vector, value = pair[:, place[1]], np.linalg.eigvalsh(M)[1 - place[1]]
    assert abs(pair[:, 0] @ pair[:, 1]) == pytest.approx(0.0575, abs=5e-5)
    assert np.linalg.norm(M @ vector - value * vector) == pytest.approx(4.64, abs=5e-3)


def test_the_first_eigenvector_of_the_simulator_is_that_of_the_bicycle():
    claim = CLAIMS[3]
    assert claim.holds
    assert claim.ours == "(0.999586, 0.028770), (0.000000, 1.000000)"
