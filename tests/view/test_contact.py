"""Both wheels on the ground: an independent search, and the wheels' meshes as compiled.

Oracles: bisection on a sampled rim; the small-angle pitch is none to first order.
"""

import math

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.view.contact import WheelGeometry, contact_pitch, wheel_geometry
from bikesim.view.pose import Pose
from bikesim.view.road_scene import RoadScene

FIVE = ["benchmark", "browser", "davis", "pista", "rigid"]
GRID = [math.radians(angle) for angle in (-30, -17, 0, 9, 30)]
WORLD = {"ground", "road", "road markings", "shade"}
RIM = np.linspace(0, 2 * math.pi, 20001)


def rotation(axis: int, angle: float) -> np.ndarray:
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
    return turn


def lowest_of_the_front_rim(bike: WheelGeometry, roll: float, steer: float, pitch: float) -> float:
    """From rotations of sampled points, x forward, y left, z up; the ground is 0 [m]."""
    rim = bike.front_radius * np.stack([np.cos(RIM), 0 * RIM, np.sin(RIM)])
    # About the tilted axis: into its frame, about it, and back.
    tilt = rotation(1, -bike.tilt)
    turn = tilt @ rotation(2, -steer) @ tilt.T
    on_axis = np.array([bike.wheelbase + bike.trail, 0, -bike.rear_radius])
    axle = np.array([bike.wheelbase, 0, bike.front_radius - bike.rear_radius])
    points = turn @ (axle[:, None] + rim - on_axis[:, None]) + on_axis[:, None]
    raised = rotation(0, roll) @ rotation(1, pitch) @ points
    return bike.rear_radius * math.cos(roll) + raised[2].min()


@pytest.fixture(scope="module", params=FIVE)
def scene(request: pytest.FixtureRequest) -> RoadScene:
    return RoadScene(bicycles.load(request.param), path=None, roll_cue=True)


def shown(scene: RoadScene, **values: float) -> RoadScene:
    scene.show(Pose(**dict.fromkeys(Pose._fields, 0.0) | values))
    return scene


def wheel_points(scene: RoadScene, wheel: str) -> np.ndarray:
    """The corners of a tyre in the world [m]."""
    return drawn_points(scene, f"{wheel} tyre")


def drawn_points(scene: RoadScene, name: str) -> np.ndarray:
    """The corners of a mesh in the world [m]."""
    model, data = scene.model, scene.data
    geom = model.geom(name)
    mesh = model.mesh(int(geom.dataid[0]))
    first = int(mesh.vertadr[0])
    corners = model.mesh_vert[first : first + int(mesh.vertnum[0])]
    return data.geom_xpos[geom.id] + corners @ data.geom_xmat[geom.id].reshape(3, 3).T


@pytest.mark.parametrize("name", FIVE)
@pytest.mark.parametrize("roll", GRID)
@pytest.mark.parametrize("steer", GRID)
def test_the_front_rim_just_touches_the_ground(name: str, roll: float, steer: float):
    bike = wheel_geometry(bicycles.load(name))
    pitch = contact_pitch(bike, roll, steer)
    assert abs(lowest_of_the_front_rim(bike, roll, steer, pitch)) < 1e-7


@pytest.mark.parametrize("roll", GRID)
@pytest.mark.parametrize("wheel", ["rear", "front"])
def test_drawn_tyres_touch_the_ground(scene: RoadScene, roll: float, wheel: str):
    for steer in GRID:
        lowest = wheel_points(shown(scene, roll=roll, steer=steer), wheel)[:, 2].min()
        assert abs(lowest) < 0.0005


def test_rear_wheel_touches_at_the_recorded_place(scene: RoadScene):
    points = wheel_points(shown(scene, roll=0.4, steer=0.2, heading=0.7, x=123.0), "rear")
    lowest = points[points[:, 2].argmin()]
    # The bicycle stands at the origin; a corner of the tyre is within half a side of the touch.
    assert np.hypot(*lowest[:2]) < 0.02


@pytest.mark.parametrize(("roll", "steer"), [(1.2, 1.0), (-1.3, 0.9), (0.9, -1.0)])
def test_far_beyond_any_ride_it_still_touches(roll: float, steer: float):
    bike = wheel_geometry(bicycles.load("benchmark"))
    pitch = contact_pitch(bike, roll, steer)
    assert abs(lowest_of_the_front_rim(bike, roll, steer, pitch)) < 1e-6


def test_upright_and_straight_there_is_no_pitch():
    assert contact_pitch(wheel_geometry(bicycles.load("pista")), 0.0, 0.0) == 0.0


def test_pitch_is_the_same_in_a_mirror():
    bike = wheel_geometry(bicycles.load("browser"))
    assert contact_pitch(bike, 0.3, -0.4) == pytest.approx(
        contact_pitch(bike, -0.3, 0.4), abs=1e-14
    )


def test_a_bicycle_known_by_matrices_has_its_own_geometry_on_usual_wheels():
    davis = bicycles.load("davis")
    bike = wheel_geometry(davis)
    assert bike.wheelbase == davis.wheelbase
    assert bike.front_radius == bike.rear_radius == pytest.approx(0.335)


def test_drawn_axles_have_the_wheelbase(scene: RoadScene):
    data = shown(scene).data
    rear, front = data.body("rear_wheel").xpos, data.body("front_wheel").xpos
    assert front[0] - rear[0] == pytest.approx(scene._cyclist.geometry.wheelbase, abs=1e-9)


def test_drawn_steer_axis_has_the_trail(scene: RoadScene):
    data = shown(scene).data
    anchor, down = data.joint("steer").xanchor, data.joint("steer").xaxis
    on_ground = anchor - down * anchor[2] / down[2]
    trail = on_ground[0] - data.body("front_wheel").xpos[0]
    assert trail == pytest.approx(scene._cyclist.geometry.trail, abs=1e-9)


def test_drawn_wheels_have_their_radii(scene: RoadScene):
    shown(scene)
    geometry = scene._cyclist.geometry
    for wheel, radius in (("rear", geometry.rear_radius), ("front", geometry.front_radius)):
        height = scene.data.body(f"{wheel}_wheel").xpos[2]
        assert height == pytest.approx(radius, abs=1e-9)
        assert np.ptp(wheel_points(scene, wheel)[:, 2]) == pytest.approx(2 * radius, abs=1e-3)


@pytest.mark.parametrize("side", [1, -1])
def test_nothing_of_bicycle_or_rider_is_under_the_road(scene: RoadScene, side: int):
    roll, steer = side * math.radians(30), side * math.radians(8)
    for distance in np.linspace(0, 6, 7):
        shown(scene, roll=roll, steer=steer, distance=distance)
        heights = {name: drawn_points(scene, name)[:, 2].min() for name in cyclist_geoms(scene)}
        assert min(heights.values()) > -0.001, heights


def cyclist_geoms(scene: RoadScene) -> list[str]:
    """What is drawn of bicycle and rider."""
    names = [scene.model.geom(k).name for k in range(scene.model.ngeom)]
    return [name for name in names if name and " at " not in name and name not in WORLD]
