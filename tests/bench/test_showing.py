import numpy as np
import pytest

from bikesim import bicycles
from bikesim.bench.profile import load_bench
from bikesim.bench.scenario import bench_scenario
from bikesim.bench.showing import read_showing, showing_of
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario

BENCH = load_bench("cia402-emulated").model_copy(update={"wheel": None})


def through(bicycle: str = "benchmark", **keys):
    scenario = bench_scenario(BENCH, Scenario.model_validate(keys))
    return read_showing(showing_of(BENCH, scenario, bicycles.load(bicycle)).to_text())


@pytest.mark.parametrize("name", ["benchmark", "davis"])  # by parameters; by matrices
def test_a_bicycle_comes_through_whole(name: str):
    bicycle = bicycles.load(name)
    read = through(name).bicycle
    assert (read.name, read.parameters) == (bicycle.name, bicycle.parameters)
    for key in ("M", "C1", "K0", "K2"):
        np.testing.assert_array_equal(getattr(read.matrices, key), getattr(bicycle.matrices, key))
    assert (read.wheelbase, read.trail, read.steer_axis_tilt) == (
        bicycle.wheelbase, bicycle.trail, bicycle.steer_axis_tilt,
    )  # fmt: skip


def test_the_cues_come_through():
    vision = {"roll_cue": False, "delay": 0.2, "preview": 1.5, "occlusions": [[2, 3], [4, 5.5]]}
    read = through(vision=vision, law="off")
    assert (read.roll_cue, read.delay, read.preview) == (False, 0.2, 1.5)
    assert read.occlusions == ((2.0, 3.0), (4.0, 5.5))
    assert read.haptics == "haptics off"
    assert read.ramp_in == BENCH.thresholds.ramp_in


def test_a_straight_path_needs_no_points():
    assert through(path="straight").path is None


def test_a_circle_to_the_right_keeps_its_radius():
    path = through(path={"kind": "circle", "radius": 15.0, "start": 5.0, "entry": 2.0}).path
    assert path is not None
    far = path[path[:, 1] > 10]
    # Three points of a circle give its middle.
    (ax, ay), (bx, by), (cx, cy) = far[[0, len(far) // 2, -1]]
    middle = np.linalg.solve(
        2 * np.array([[bx - ax, by - ay], [cx - ax, cy - ay]]),
        [bx**2 + by**2 - ax**2 - ay**2, cx**2 + cy**2 - ax**2 - ay**2],
    )
    assert middle[1] > 10
    np.testing.assert_allclose(np.hypot(*(far - middle).T), 15.0, atol=0.02)


def test_an_open_path_reaches_beyond_what_can_be_ridden():
    path = through(path="slalom", speed=5.0, duration=600.0).path
    assert path is not None
    assert path[0, 0] < -100
    assert path[-1, 0] > 5.0 * 600 + 100
    most = through(path="slalom", speed=5.0, duration=80_000.0).path
    assert most is not None
    assert most[-1, 0] < 30_000


@pytest.mark.parametrize("text", ["", "7", "[]", "{}", '{"version": 2}', "not JSON"])
def test_what_another_version_wrote_is_refused(text: str):
    with pytest.raises(InputError, match="of another version of bikesim"):
        read_showing(text)
