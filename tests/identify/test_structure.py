import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.identify.structure import STRUCTURES, structure


@pytest.mark.parametrize("arms", [False, True])
@pytest.mark.parametrize("name", STRUCTURES)
def test_each_term_has_a_gain(name: str, arms: bool):
    found = structure(name, arms=arms)
    assert len(found.gains) == len(found.terms) == len({gain.name for gain in found.gains})
    assert found.to_gains(np.arange(1.0, len(found.terms) + 1)).shape == (len(found.terms),)


def test_the_loops_of_hess_multiplied_out_give_their_gains_back():
    """U as in the paper is linear in the signals: its slopes are the coefficients."""
    gains = np.array([44.64, -0.0529, 13.2253, 0.172, 0.1001])  # [H12], benchmark at 4.8 m/s
    found = structure("hess2012")

    def intended(**signals: float) -> float:
        value = {term.signal: 0.0 for term in found.terms} | signals
        heading = gains[4] * (0 - value["front_y"])
        roll = gains[3] * (heading - value["heading"])
        roll_rate = gains[2] * (roll - value["roll"])
        steer = gains[1] * (roll_rate - value["roll_rate"])
        return gains[0] * (steer - value["steer"])

    coefficients = np.array([intended(**{term.signal: 1.0}) for term in found.terms])
    assert found.to_gains(coefficients) == pytest.approx(gains, rel=1e-12)
    assert [gain.name for gain in found.gains] == ["k_delta", "k_phi_dot", "k_phi", "k_psi", "k_y"]


def test_arms_resist():
    found = structure("roll-pd", arms=True)
    assert found.to_gains(np.array([1.0, 2.0, -0.1, -2.0, -5.0])).tolist() == [1, 2, 0.1, 2, 5]


def test_an_unknown_structure():
    with pytest.raises(InputError, match=r"unknown structure .*; did you mean schwab2013\?"):
        structure("shwab2013")
