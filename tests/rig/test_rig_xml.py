"""The mechanism in mjcf/rig.xml: one balanced hinge with the paper's signs.

Oracles: Table 1 of Schwab & Recuero 2013, statics, and the geometry of a right turn.
"""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

BENCHMARK_LAMBDA2 = 0.2310850117  # kg m², smaller eigenvalue of M, Table 1
BENCHMARK_STEER_AXIS_TILT = math.pi / 10
STEER_ANGLES = [-1.0, -0.3, 0.0, 0.5, 1.0]


@pytest.fixture
def spec(repository: Path) -> mujoco.MjSpec:
    return mujoco.MjSpec.from_file(str(repository / "mjcf" / "rig.xml"))


@pytest.fixture(scope="module")
def model(repository: Path) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(repository / "mjcf" / "rig.xml"))


def at_steer(model: mujoco.MjModel, steer: float, steer_rate: float = 0.0) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[0] = steer
    data.qvel[0] = steer_rate
    mujoco.mj_forward(model, data)
    return data


def tilted(spec: mujoco.MjSpec, tilt: float) -> mujoco.MjModel:
    spec.body("head").quat = np.array([math.cos(tilt / 2), 0, -math.sin(tilt / 2), 0])
    return spec.compile()


def test_nothing_moves_but_the_steer_hinge(model: mujoco.MjModel):
    assert (model.nq, model.nv, model.joint(0).name) == (1, 1, "steer")


def test_inertia_about_the_axis_is_that_of_table_1(model: mujoco.MjModel):
    mass_matrix = np.zeros((1, 1))
    mujoco.mj_fullM(model, at_steer(model, 0.4), mass_matrix)
    assert mass_matrix[0, 0] == pytest.approx(BENCHMARK_LAMBDA2, rel=1e-14)


@pytest.mark.parametrize("steer", STEER_ANGLES)
def test_gravity_gives_no_torque_about_the_axis(model: mujoco.MjModel, steer: float):
    assert abs(at_steer(model, steer).qfrc_bias[0]) < 1e-14


@pytest.mark.parametrize("steer", STEER_ANGLES)
def test_gravity_gives_no_torque_at_another_head_angle(spec: mujoco.MjSpec, steer: float):
    assert abs(at_steer(tilted(spec, 0.5), steer).qfrc_bias[0]) < 1e-14


def test_file_is_passive(model: mujoco.MjModel):
    passive = [model.dof_damping, model.dof_frictionloss, model.dof_armature, model.jnt_stiffness]
    assert not np.any(passive)


def test_axis_points_down_and_forward(model: mujoco.MjModel):
    axis = at_steer(model, 0.0).xaxis[0]
    tilt = BENCHMARK_STEER_AXIS_TILT
    np.testing.assert_allclose(axis, [math.sin(tilt), 0, -math.cos(tilt)], atol=1e-15)


@pytest.mark.parametrize("tilt", [0.2, 0.5])
def test_axis_follows_the_head_angle(spec: mujoco.MjSpec, tilt: float):
    axis = at_steer(tilted(spec, tilt), 0.0).xaxis[0]
    np.testing.assert_allclose(axis, [math.sin(tilt), 0, -math.cos(tilt)], atol=1e-15)


def test_turning_right_moves_the_right_grip_backwards(model: mujoco.MjModel):
    straight, turned = (at_steer(model, steer).site("grip_right").xpos for steer in (0.0, 0.2))
    assert straight[1] < 0
    assert turned[0] < straight[0] - 0.04


def test_turning_right_moves_the_left_grip_forward(model: mujoco.MjModel):
    straight, turned = (at_steer(model, steer).site("grip_left").xpos for steer in (0.0, 0.2))
    assert straight[1] > 0
    assert turned[0] > straight[0] + 0.04


def test_turning_right_turns_the_front_of_the_bar_to_the_right(model: mujoco.MjModel):
    forward = at_steer(model, 0.2).body("handlebar").xmat.reshape(3, 3)[:, 0]
    assert forward[1] == pytest.approx(-math.sin(0.2))


def test_actuators_in_order(model: mujoco.MjModel):
    assert [model.actuator(k).name for k in range(model.nu)] == ["motor", "rider"]


def test_sensors_in_order(model: mujoco.MjModel):
    assert [model.sensor(k).name for k in range(model.nsensor)] == ["steer_angle", "steer_rate"]


def test_sensor_values_are_angle_and_rate(model: mujoco.MjModel):
    data = at_steer(model, 0.3, steer_rate=0.7)
    np.testing.assert_allclose(data.sensordata, [0.3, 0.7], atol=0)


@pytest.mark.parametrize("actuator", ["motor", "rider"])
def test_control_is_torque_at_the_handlebar(model: mujoco.MjModel, actuator: str):
    data = mujoco.MjData(model)
    data.actuator(actuator).ctrl = 1.5
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(1.5 / BENCHMARK_LAMBDA2, rel=1e-9)


def test_stop_holds_against_a_strong_rider(model: mujoco.MjModel):
    data = mujoco.MjData(model)
    data.actuator("rider").ctrl = 10.0
    mujoco.mj_step(model, data, 4000)
    assert data.qpos[0] == pytest.approx(math.radians(60), abs=1e-4)
    assert abs(data.qvel[0]) < 1e-9


def test_stop_takes_the_speed_of_an_impact(model: mujoco.MjModel):
    data = at_steer(model, 1.0, steer_rate=8.0)
    mujoco.mj_step(model, data, 40)
    assert -0.5 < data.qvel[0] < 0
    assert data.qpos[0] < math.radians(60.5)


def test_drawing_has_no_part_in_the_physics(spec: mujoco.MjSpec, model: mujoco.MjModel):
    for geom in list(spec.geoms):
        spec.delete(geom)
    bare = spec.compile()
    drawn_data, bare_data = at_steer(model, 0.2, 0.5), at_steer(bare, 0.2, 0.5)
    mujoco.mj_step(model, drawn_data, 100)
    mujoco.mj_step(bare, bare_data, 100)
    assert bare_data.qpos[0] == drawn_data.qpos[0]


@pytest.mark.parametrize("name", ["bench", "side", "top_of_bar"])
def test_cameras_are_named(model: mujoco.MjModel, name: str):
    assert model.camera(name).name == name


def test_eye_is_above_the_saddle_and_looks_at_the_picture(model: mujoco.MjModel):
    data = at_steer(model, 0.0)
    eye, picture = data.site("eye").xpos, data.geom("picture")
    assert eye[2] > 1.4
    normal = picture.xmat.reshape(3, 3)[:, 2]
    assert normal @ (eye - picture.xpos) > 0.8
