import numpy as np
import pytest

from bikesim.identify.noise import WHITE, autoregression, before, whitened

COEFFICIENTS = np.array([1.0, -1.4, 0.6])


def coloured(count: int, seed: int = 3) -> np.ndarray:
    white = np.random.default_rng(seed).standard_normal(count)
    values = np.zeros(count)
    for i in range(count):
        values[i] = white[i] - COEFFICIENTS[1:] @ [values[i - 1], values[i - 2]]
    return values


def test_order_and_coefficients_are_found():
    found = autoregression([coloured(6000), coloured(3000, seed=4)])
    assert found == pytest.approx(COEFFICIENTS, abs=0.05)
    assert autoregression([np.random.default_rng(1).standard_normal(4000)]).tolist() == [1]
    assert len(autoregression([coloured(6000)], 5)) == 6


def test_what_is_whitened_is_white_again():
    values = coloured(6000)
    white = whitened(COEFFICIENTS, values)
    assert white == pytest.approx(np.random.default_rng(3).standard_normal(6000)[2:], abs=1e-9)
    both = whitened(COEFFICIENTS, np.column_stack([values, 2 * values]))
    assert both[:, 1] == pytest.approx(2 * white)
    assert whitened(WHITE, values).tolist() == values.tolist()


def test_the_values_before():
    assert before(2, np.arange(5.0)).tolist() == [[1, 0], [2, 1], [3, 2]]
    assert before(0, np.arange(5.0)).shape == (5, 0)
