import math
from typing import Any

import pytest

from bikesim.experiment.handling import handling_quality_peak
from bikesim.experiment.scenario import Scenario


def peak(**keys: Any) -> float:
    return handling_quality_peak(Scenario(**keys))


def test_under_the_momentum_law_it_is_that_of_the_bicycle():
    """Moore, Hubbard & Hess 2016: 4.64 is the largest at the frequencies that they looked at."""
    assert peak(rider="hess2012", speed=5.0, law="momentum") == pytest.approx(4.64, rel=0.012)


def test_gains_of_his_own():
    """Those published for 5 m/s, given in full."""
    gains = {"k_delta": 46.5457, "k_phi_dot": -0.0522, "k_phi": 12.6611, "k_psi": 0.0, "k_y": 0.0}
    own = peak(rider={"name": "hess2012", **gains}, speed=5.0, law="momentum")
    assert own == pytest.approx(4.64, rel=0.012)


def test_a_profile_counts_by_its_first_speed():
    by_profile = peak(rider="hess2012", speed_profile=[[0.0, 5.0], [10.0, 8.0]])
    assert by_profile == peak(rider="hess2012", speed=5.0)


@pytest.mark.parametrize(
    "keys",
    [{"rider": "human"}, {"rider": "hess2012", "speed": 5.0, "law": "off"}],
    ids=["another rider", "not stable"],
)
def test_where_it_is_not_defined(keys: dict[str, Any]):
    assert math.isnan(peak(**keys))
