import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.bicycle import Bicycle
from bikesim.report.eigenvalue_table import EigenvalueTable, eigenvalue_table

SPEEDS = [0.5, 2.0, 3.5, 5.0, 8.0]


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return bicycles.load("benchmark")


@pytest.fixture(scope="module")
def table(benchmark: Bicycle) -> EigenvalueTable:
    return eigenvalue_table(benchmark, SPEEDS)


def companion(M, C, K) -> np.ndarray:
    """Eigenvalues of M q̈ + C q̇ + K q = 0 by the first-order form."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    return np.sort_complex(np.linalg.eigvals(A))


def matrices(bicycle: Bicycle, v: float):
    m = bicycle.matrices
    return m.M, v * m.C1, bicycle.gravity * m.K0 + v**2 * m.K2


@pytest.mark.parametrize("i", range(len(SPEEDS)))
def test_the_bicycle_by_an_independent_computation(table, benchmark, i: int):
    expected = companion(*matrices(benchmark, SPEEDS[i]))
    assert np.sort_complex(np.array(table.rows[i].bicycle.all())) == pytest.approx(
        expected, abs=1e-10
    )


@pytest.mark.parametrize("i", range(len(SPEEDS)))
@pytest.mark.parametrize("inertia", [None, 0.3])
def test_the_law_of_the_paper_by_an_independent_computation(benchmark, i: int, inertia):
    """Eq. 7: the same matrices, but [M_φφ 0; M_δφ I]."""
    M, C, K = matrices(benchmark, SPEEDS[i])
    smaller = np.linalg.eigvalsh(M)[0]
    M_sim = np.array([[M[0, 0], 0], [M[1, 0], inertia or smaller]])
    (row,) = eigenvalue_table(benchmark, [SPEEDS[i]], inertia).rows
    expected = companion(M_sim, C, K)
    assert np.sort_complex(np.array(row.paper.all())) == pytest.approx(expected, abs=1e-10)


def test_json_is_the_table(table: EigenvalueTable):
    for row, told in zip(table.rows, table.as_json()["rows"], strict=True):
        assert told["speed_m_s"] == row.speed
        for whose in ("bicycle", "paper", "momentum"):
            modes = getattr(row, whose)
            assert [complex(*pair) for pair in told[whose]] == list(modes.all())


def test_text_has_three_lines_a_speed(table: EigenvalueTable):
    lines = table.as_text()
    assert [line[:2] for line in lines[:4]] == [
        ["0.5", "bicycle"], ["", "paper"], ["", "momentum"], ["2", "bicycle"],
    ]  # fmt: skip


def test_text_of_published_eigenvalues(benchmark: Bicycle):
    """[M07, Table 2] at 5 m/s."""
    line = eigenvalue_table(benchmark, [5]).as_text()[0]
    assert line == ["5", "bicycle", "-14.0784", "-0.3229", "-0.7753 ± 4.4649i"]


def test_text_of_a_weave_that_does_not_oscillate(benchmark: Bicycle):
    """At rest: two pairs of real eigenvalues of opposite sign [M07]: ±3.1316 and ±5.5309."""
    line = eigenvalue_table(benchmark, [0]).as_text()[0]
    assert sorted(", ".join(line[2:]).split(", ")) == sorted(
        ["-5.5309", "-3.1316", "3.1316", "5.5309"]
    )
