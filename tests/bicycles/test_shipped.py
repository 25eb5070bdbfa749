from dataclasses import replace

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.bicycle import Bicycle
from bikesim.model.parameters import BicycleParameters

# [S13], Davis bicycle with rider: printed with 8 decimals.
DAVIS = {
    "M": [[133.31668525, 2.43885691], [2.43885691, 0.22419262]],
    "C1": [[0, 44.65783277], [-0.31500940, 1.46189246]],
    "K0": [[-116.73261635, -2.48042260], [-2.48042260, -0.77434358]],
    "K2": [[0, 104.85805076], [0, 2.29688720]],
}


def parameters(name: str) -> BicycleParameters:
    found = bicycles.load(name).parameters
    assert found is not None
    return found


def test_names():
    assert bicycles.names() == ("benchmark", "browser", "davis", "pista", "rigid", "rigid-early")


@pytest.mark.parametrize("name", bicycles.names())
def test_every_shipped_bicycle_loads_with_its_name_and_source(name):
    bicycle = bicycles.load(name)
    assert bicycle.name == name
    assert len(bicycle.source) > 40
    assert "\n" not in bicycle.source


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("benchmark", "BenchmarkBenchmark.txt"),
        ("rigid", "RigidJasonPar.txt"),
        ("rigid-early", "RigidPar.txt"),
    ],
)
def test_parameters_are_those_of_the_reference(shared, name, file):
    reference = bicycles.load(shared / "reference/bicycles" / file)
    assert parameters(name) == reference.parameters
    assert bicycles.load(name).gravity == reference.gravity


@pytest.mark.parametrize(("name", "file"), [("browser", "BrowserPar"), ("pista", "PistaPar")])
def test_wheels_that_humancontrol_swaps_are_put_right(shared, name, file):
    swapped = bicycles.load(shared / f"reference/bicycles/{file}.txt").parameters
    assert swapped is not None
    assert parameters(name) == replace(swapped, IRxx=swapped.IFxx, IFxx=swapped.IRxx)


@pytest.mark.parametrize("wheel", ["IRxx", "IRyy", "IFxx", "IFyy"])
def test_browser_has_the_measured_wheels(shared, wheel):
    measured = bicycles.load(shared / "reference/bicycles/BrowserBenchmark.txt").parameters
    assert getattr(parameters("browser"), wheel) == pytest.approx(
        getattr(measured, wheel), abs=4e-4
    )


def test_pista_has_the_measured_wheels():
    # BicycleParameters, PistaBenchmark.txt.
    assert parameters("pista").IRxx == pytest.approx(0.0552268228143, abs=2e-7)
    assert parameters("pista").IFxx == pytest.approx(0.0553476418952, abs=4e-7)


@pytest.mark.parametrize("name", DAVIS)
def test_davis_has_the_published_matrices(name):
    np.testing.assert_array_equal(getattr(bicycles.load("davis").matrices, name), DAVIS[name])


def test_davis_is_known_by_its_matrices_only():
    assert bicycles.load("davis").parameters is None


@pytest.mark.parametrize("name", DAVIS)
def test_rigid_is_the_bicycle_of_the_davis_matrices(name):
    matrix = getattr(bicycles.load("rigid").matrices, name)
    np.testing.assert_allclose(matrix, DAVIS[name], rtol=0, atol=5.1e-9)


def spin(davis: Bicycle) -> tuple[float, float]:
    """S_T and S_F [kg m], the spin of both wheels and of the front one, out of K2[φδ], C1[δφ]."""
    m, cos = davis.matrices, np.cos(davis.steer_axis_tilt)
    S_T = m.K2[0, 1] * davis.wheelbase / cos + m.K0[0, 0]
    return S_T, -m.C1[1, 0] / cos - davis.trail / davis.wheelbase * S_T


def test_davis_matrices_and_geometry_belong_together():
    davis = bicycles.load("davis")
    _, S_F = spin(davis)
    S_A, tilt = -davis.matrices.K0[0, 1], davis.steer_axis_tilt
    K2_dd = (S_A + S_F * np.sin(tilt)) / davis.wheelbase * np.cos(tilt)
    assert davis.matrices.K0[1, 1] == pytest.approx(-S_A * np.sin(tilt), abs=2e-8)
    assert davis.matrices.K2[1, 1] == pytest.approx(K2_dd, abs=2e-8)


def test_davis_wheels_are_the_measured_ones(shared):
    p = bicycles.load(shared / "reference/bicycles/RigidBenchmark.txt").parameters
    assert p is not None
    front = p.IFyy / p.rF
    assert spin(bicycles.load("davis")) == pytest.approx((p.IRyy / p.rR + front, front), abs=3e-8)


@pytest.mark.parametrize("name", bicycles.names())
def test_every_shipped_bicycle_survives_being_written(tmp_path, name):
    shipped = bicycles.load(name)
    (tmp_path / "copy.toml").write_text(bicycles.to_toml(shipped), encoding="utf-8")
    copy = bicycles.load(tmp_path / "copy.toml")
    assert (copy.name, copy.source, copy.gravity) == (name, shipped.source, shipped.gravity)
    assert copy.parameters == shipped.parameters
    for matrix in DAVIS:
        np.testing.assert_array_equal(
            getattr(copy.matrices, matrix), getattr(shipped.matrices, matrix)
        )
