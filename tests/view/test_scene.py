"""What a pose does to the bodies of the scene; signs as in the record."""

import math

import mujoco
import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.view.pose import Pose
from bikesim.view.scene import Scene, bench_scene, road_scene
from bikesim.view.shapes import rider

NOWHERE = Pose(0, 0, 0, 0, 0, 0, 0, 0)
WINDOW = 720.0  # m, period of the land


@pytest.fixture(scope="module")
def scene() -> Scene:
    return road_scene(bicycles.load("benchmark"))


@pytest.fixture(scope="module")
def bench() -> Scene:
    return bench_scene(bicycles.load("browser"))


def after(scene: Scene, pose: Pose) -> mujoco.MjData:
    scene.show(pose)
    return scene.data


def in_the_rear_frame(data: mujoco.MjData, point: np.ndarray) -> np.ndarray:
    frame = data.body("frame")
    return frame.xmat.reshape(3, 3).T @ (point - frame.xpos)


def test_roll_to_the_right_takes_the_shoulders_to_the_right(scene: Scene):
    data = after(scene, NOWHERE._replace(roll=0.3))
    middle = 0.5 * (data.site("shoulder left").xpos + data.site("shoulder right").xpos)
    assert middle[1] == pytest.approx(-math.tan(0.3) * middle[2], rel=0.02)


def test_heading_to_the_right_turns_to_the_right(scene: Scene):
    forward = after(scene, NOWHERE._replace(heading=0.4)).body("frame").xmat.reshape(3, 3)[:, 0]
    np.testing.assert_allclose(forward, [math.cos(0.4), -math.sin(0.4), 0], atol=1e-12)


def test_steer_to_the_right_turns_the_front_wheel_to_the_right(scene: Scene):
    axle = after(scene, NOWHERE._replace(steer=0.2)).body("front_wheel").xmat.reshape(3, 3)[:, 1]
    assert axle[0] > 0.15
    assert axle[1] > 0.9


def test_a_place_to_the_right_has_the_road_to_the_left(scene: Scene):
    data = after(scene, NOWHERE._replace(y=1.5))
    assert data.body("road").xpos[1] == pytest.approx(1.5)


@pytest.mark.parametrize("x", [3.0, 800.0, -91.0])
def test_the_road_moves_backwards_by_whole_periods(scene: Scene, x: float):
    moved = after(scene, NOWHERE._replace(x=x)).body("road").xpos[0] + x
    assert moved / 12 == pytest.approx(round(moved / 12), abs=1e-7)


@pytest.mark.parametrize("distance", [0.4, 2.0, 7013.0])
@pytest.mark.parametrize(("wheel", "radius"), [("rear", 0.30), ("front", 0.35)])
def test_wheels_turn_by_distance_over_radius(
    scene: Scene, wheel: str, radius: float, distance: float
):
    data = after(scene, NOWHERE._replace(distance=distance))
    turned = data.joint(f"{wheel}_wheel").qpos[0] - distance / radius
    assert turned / (2 * math.pi) == pytest.approx(round(turned / (2 * math.pi)), abs=1e-9)


def test_wheels_roll_forward(scene: Scene):
    data = after(scene, NOWHERE._replace(distance=0.1))
    top = data.body("rear_wheel").xmat.reshape(3, 3) @ [0, 0, 1]
    assert top[0] == pytest.approx(math.sin(0.1 / 0.30))


@pytest.mark.parametrize("steer", np.radians([-30, -10, 0, 20, 30]))
@pytest.mark.parametrize("side", ["left", "right"])
def test_arms_reach_the_grips(scene: Scene, steer: float, side: str):
    data = after(scene, NOWHERE._replace(steer=steer, roll=-0.4 * steer))
    forearm = data.body(f"forearm {side}")
    end = forearm.xpos + rider.FOREARM * forearm.xmat.reshape(3, 3)[:, 2]
    np.testing.assert_allclose(end, data.site(f"wrist {side}").xpos, atol=1e-3)


@pytest.mark.parametrize("distance", np.linspace(0, 5.0, 6))
@pytest.mark.parametrize("side", ["left", "right"])
def test_legs_reach_the_pedals(scene: Scene, distance: float, side: str):
    data = after(scene, NOWHERE._replace(distance=distance, roll=0.2))
    shank = data.body(f"shank {side}")
    end = shank.xpos + rider.SHANK * shank.xmat.reshape(3, 3)[:, 2]
    np.testing.assert_allclose(end, data.site(f"ankle {side}").xpos, atol=1e-3)


@pytest.mark.parametrize(("upper", "lower", "length"), [
    ("thigh", "shank", rider.THIGH), ("upper arm", "forearm", rider.UPPER_ARM),
])  # fmt: skip
def test_bones_meet_in_their_joint(scene: Scene, upper: str, lower: str, length: float):
    data = after(scene, NOWHERE._replace(distance=1.3, steer=0.2))
    bone = data.body(f"{upper} left")
    end = bone.xpos + length * bone.xmat.reshape(3, 3)[:, 2]
    np.testing.assert_allclose(end, data.body(f"{lower} left").xpos, atol=2e-3)


def test_knees_bend_forward_and_elbows_outward(scene: Scene):
    data = after(scene, NOWHERE._replace(roll=0.3))
    knee, hip = (in_the_rear_frame(data, data.body(f"{n} left").xpos) for n in ("shank", "thigh"))
    elbow = in_the_rear_frame(data, data.body("forearm left").xpos)
    shoulder = in_the_rear_frame(data, data.site("shoulder left").xpos)
    assert knee[0] > hip[0] + 0.1
    assert elbow[1] > shoulder[1]


def test_a_pose_alone_decides_what_is_shown(scene: Scene):
    pose = Pose(1.0, 5.0, 0.2, -0.1, 3.0, 4321.0, -77.0, 5000.0)
    first = after(scene, pose)
    kept = first.geom_xpos.copy(), first.cam_xmat.copy(), scene.model.geom_rgba.copy()
    after(scene, NOWHERE)
    again = after(scene, pose)
    np.testing.assert_array_equal(kept[0], again.geom_xpos)
    np.testing.assert_array_equal(kept[1], again.cam_xmat)
    np.testing.assert_array_equal(kept[2], scene.model.geom_rgba)


def test_without_the_roll_cue_nothing_leans():
    scene = road_scene(bicycles.load("benchmark"), roll_cue=False)
    leaning, upright = NOWHERE._replace(roll=0.4, steer=0.1), NOWHERE._replace(steer=0.1)
    shown = after(scene, leaning).geom_xpos.copy()
    np.testing.assert_array_equal(shown, after(scene, upright).geom_xpos)


def test_what_is_drawn_stays_near_the_origin(scene: Scene):
    data = after(scene, NOWHERE._replace(x=98765.4, y=-4321.0, heading=2.0))
    road = abs(data.body("road").xpos[1])
    assert np.abs(data.geom_xpos[:, 0]).max() < WINDOW
    assert road == pytest.approx(4321.0)


def test_the_number_of_things_drawn_does_not_grow(scene: Scene):
    def drawn(x: float) -> int:
        after(scene, NOWHERE._replace(x=x))
        return int((scene.model.geom_rgba[:, 3] > 0).sum())

    counts = [drawn(x) for x in (0.0, 333.0, 1e4, 1e5)]
    assert max(counts) < 100
    assert max(counts) - min(counts) < 25


def test_an_unknown_view_is_refused(scene: Scene, bench: Scene):
    with pytest.raises(InputError, match="unknown view 'frist'; did you mean first"):
        scene.camera("frist")
    with pytest.raises(InputError, match="unknown view"):
        bench.camera("second")


def test_only_the_first_view_hides_the_riders_body(scene: Scene):
    group = int(scene.model.geom("trunk").group[0])
    assert [bool(scene.option(view).geomgroup[group]) for view in scene.views] == [False, True]


def test_the_bar_of_the_bench_is_at_the_recorded_steer(bench: Scene):
    data = after(bench, NOWHERE._replace(steer=0.3))
    forward = data.body("handlebar").xmat.reshape(3, 3)[:, 0]
    assert forward[1] == pytest.approx(-math.sin(0.3))


def test_the_bench_stands_in_a_room_before_a_screen(bench: Scene):
    data = after(bench, NOWHERE)
    screen, wall = data.geom("picture"), data.geom("room wall ahead")
    assert data.body("handlebar").xpos[0] < screen.xpos[0] < wall.xpos[0]


def test_the_bench_has_the_bicycles_steer_axis(bench: Scene):
    tilt = bicycles.load("browser").steer_axis_tilt
    axis = after(bench, NOWHERE).joint("steer").xaxis
    np.testing.assert_allclose(axis, [math.sin(tilt), 0, -math.cos(tilt)], atol=1e-12)
