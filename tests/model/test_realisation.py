import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.eigen import bicycle_modes, eigenvalues
from bikesim.model.law import Law
from bikesim.model.realisation import coded_state_matrix
from bikesim.model.simulator import simulator_matrices


def _sorted(values: np.ndarray) -> np.ndarray:
    return np.array(sorted(values.astype(complex), key=lambda s: (round(s.real, 9), s.imag)))


@pytest.mark.parametrize("name", bicycles.names())
@pytest.mark.parametrize("speed", [0.0, 2.0, 3.5, 10.0])
def test_the_momentum_law_as_coded_is_the_bicycle(name: str, speed: float):
    bicycle = bicycles.load(name)
    coded = np.linalg.eigvals(coded_state_matrix(bicycle, Law.MOMENTUM, speed))
    true = np.array(bicycle_modes(bicycle, speed).all())
    assert np.abs(_sorted(coded) - _sorted(true)).max() <= 1e-12 * np.abs(true).max()


@pytest.mark.parametrize("law", list(Law))
def test_a_law_as_coded_is_its_equation_7(law: Law):
    bicycle = bicycles.load("benchmark")
    coded = np.linalg.eigvals(coded_state_matrix(bicycle, law, 3.5, 0.3))
    written = eigenvalues(*simulator_matrices(bicycle, law, 3.5, 0.3))
    assert np.abs(_sorted(coded) - _sorted(written)).max() < 1e-9
