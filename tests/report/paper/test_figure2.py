"""Figure 2 of the paper; figures of SCIENCE.md section 2."""

import pytest

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.report.paper.figure2 import distances, figure2, figure2_claims

BENCHMARK = bicycles.load("benchmark")
CLAIMS = {claim.claim: claim for claim in figure2_claims(BENCHMARK)}


def claim(part: str):
    (found,) = (claim for text, claim in CLAIMS.items() if part in text)
    return found


def test_distances_from_the_bicycle():
    found = distances(BENCHMARK, Law.PAPER)
    assert found.weave == pytest.approx(0.276, abs=5e-4)
    assert found.weave_real == pytest.approx(0.037, abs=5e-4)
    assert found.capsize == pytest.approx(0.020, abs=5e-4)
    assert found.castering == pytest.approx(1.10, abs=5e-3)


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ("weave speed of the bicycle", 4.29238253634111),
        ("weave speed of the simulator, I = λ2", 4.30097182174),
        ("weave speed of the simulator, I = 0.3", 4.51083841507),
        ("capsize speed of all three", 6.02426201538837),
    ],
)
def test_speeds_of_the_stability_limits(part: str, expected: float):
    found = claim(part)
    assert found.ours == pytest.approx(expected, abs=1e-9)
    assert found.holds


def test_eigenvalues_at_the_paper_s_speed():
    found = claim("at 3.5 m/s")
    assert found.ours == "1.1367 ± 2.6705i, -2.1632, -10.9161"
    assert found.holds


@pytest.mark.parametrize(
    ("mode", "holds"), [("weave", True), ("capsize", True), ("castering", False)]
)
def test_what_is_strikingly_similar(mode: str, holds: bool):
    assert claim(f"similarity to the bicycle, {mode}").holds is holds


def test_the_momentum_law_is_the_bicycle():
    assert max(distances(BENCHMARK, Law.MOMENTUM)) < 1e-12 * 25
    assert claim("Momentum law").holds


def test_the_figure_has_a_column_for_each_inertia_and_law():
    titles = [axes.get_title(loc="left") for axes in figure2(BENCHMARK).axes]
    inertias = [title.partition("=")[2] for title in titles if title]
    assert inertias == [" λ₂ = 0.2311 kg m²", " 0.3 kg m²", " 0.2313 kg m²"]
