import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bikesim import bicycles
from bikesim.bicycles.body import BODY_KEYS, RigidBody
from bikesim.bicycles.keyvalues import parse_key_values
from bikesim.errors import InputError
from bikesim.model.parameters import PARAMETER_NAMES

RIDER = {"m": 72.0, "x": 0.29, "z": -1.1, "Ixx": 8.0, "Iyy": 8.1, "Izz": 2.4, "Ixz": -1.9}
POINTS = st.lists(
    st.tuples(st.floats(0.1, 50), st.floats(-1, 1), st.floats(-2, 0)), min_size=1, max_size=5
)


def of_points(points) -> RigidBody:
    """The body of point masses (m, x, z) in the plane y = 0, straight from the definition."""
    m, x, z = np.array(points).T
    x0, z0 = m @ x / m.sum(), m @ z / m.sum()
    dx, dz = x - x0, z - z0
    return RigidBody(
        m.sum(), x0, z0, m @ dz**2 + 1, m @ (dx**2 + dz**2) + 1, m @ dx**2 + 1, -m @ (dx * dz)
    )


@given(POINTS, POINTS)
@settings(max_examples=50, deadline=None)
def test_joined_is_the_body_of_all_points(some, others):
    joined, whole = of_points(some).joined(of_points(others)), of_points(some + others)
    got = [getattr(joined, name) for name in RIDER]
    # of_points adds 1 kg m² to each moment of inertia so that a single point is a body too.
    want = [getattr(whole, name) + (name in ("Ixx", "Iyy", "Izz")) for name in RIDER]
    assert got == pytest.approx(want, rel=1e-9, abs=1e-9)


def test_rigid_frame_and_jason_are_the_published_rear_frame(shared):
    folder = shared / "reference/bicycles"
    merged = bicycles.load(f"{folder}/RigidBenchmark.txt+{folder}/JasonRigidBenchmark.txt")
    published = bicycles.load(folder / "RigidJasonPar.txt")
    for key in PARAMETER_NAMES:
        got, want = getattr(merged.parameters, key), getattr(published.parameters, key)
        assert got == pytest.approx(want, rel=1e-9), key


def test_browser_frame_and_jason_are_browser_within_the_uncertainty(shared):
    folder = shared / "reference/bicycles"
    merged = bicycles.load(f"{folder}/BrowserBenchmark.txt+{folder}/JasonBrowserBenchmark.txt")
    measured = parse_key_values((folder / "BrowserBenchmark.txt").read_text(), "Browser")
    for key in PARAMETER_NAMES:
        got = getattr(merged.parameters, key)
        want = getattr(bicycles.load("browser").parameters, key)
        assert got == pytest.approx(want, rel=0, abs=2 * measured.uncertainties[key]), key


@pytest.mark.parametrize("key", BODY_KEYS)
def test_refuses_what_is_not_finite(key):
    with pytest.raises(InputError, match=f"{key} = nan: must be finite"):
        RigidBody(**RIDER | {key.replace("B", ""): float("nan")})


@pytest.mark.parametrize(("key", "value"), [("m", 0.0), ("Iyy", -1.0), ("Ixz", 9.0)])
def test_refuses_what_is_no_body(key, value):
    with pytest.raises(InputError, match=f"rider: .*{value}"):
        RigidBody(**RIDER | {key: value})
