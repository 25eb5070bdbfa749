"""The bicycle with its rider in a model: the skeleton of mjcf/world.xml, dressed and moved."""

import math

import mujoco
import numpy as np

from bikesim.view.contact import WheelGeometry, contact_pitch
from bikesim.view.limbs import bone_turn, middle_joint, within_reach
from bikesim.view.shapes import frame, front, rider, wheels
from bikesim.view.shapes.mesh import Array, Mesh, add_mesh
from bikesim.view.shapes.places import CRANK_LENGTH, PEDAL_SIDE, places

CASTER = "caster"  # the end of the name of what is there for its shadow only
_GEAR = 2.6  # turns of the rear wheel to one of the cranks
_EYE_BEHIND_GRIPS, _EYE_OVER_GRIPS = 0.50, 0.50  # m, so that hands are in sight
_KNEE_OUT = 0.12
_SIDES = (("left", 1), ("right", -1))
_LIMBS = (
    ("thigh", rider.thigh, False),
    ("shank", rider.shank, False),
    ("upper arm", rider.upper_arm, True),
    ("forearm", rider.forearm, False),
)


class Cyclist:
    """Dresses the skeleton for a geometry; then `show` puts every part where a pose has it."""

    def __init__(self, spec: mujoco.MjSpec, geometry: WheelGeometry) -> None:
        self.geometry = geometry
        self._spec = spec
        _set_chain(spec, geometry)
        _dress_bicycle(spec, geometry)
        _dress_rider(spec, geometry)

    def bind(self, model: mujoco.MjModel) -> None:
        """Looks up joints, sites and limbs in the compiled model."""
        names = (
            "heading", "roll", "eye", "pitch", "steer", "rear_wheel", "front_wheel", "crank",
            "pedal_left", "pedal_right",
        )  # fmt: skip
        self._joints = [int(model.joint(name).qposadr[0]) for name in names]
        self._sites = {
            (name, side): model.site(f"{name} {side}").id
            for name in ("hip", "shoulder", "wrist", "ankle")
            for side, _ in _SIDES
        }
        self._mocap = {
            (name, side): int(model.body(f"{name} {side}").mocapid[0])
            for name, _, _ in _LIMBS
            for side, _ in _SIDES
        }
        self._frame = model.body("frame").id

    def show(
        self, model: mujoco.MjModel, data: mujoco.MjData, heading: float, roll: float, steer: float,
        distance: float,
    ) -> None:  # fmt: skip
        """Angles [rad] and distance [m] in the record's signs."""
        geometry = self.geometry
        pitch = contact_pitch(geometry, roll, steer)
        crank = distance / (_GEAR * geometry.rear_radius)
        down = math.atan2(0.24, 0.97)
        level = math.atan(math.tan(roll) * math.cos(down))
        data.qpos[self._joints] = [
            heading, roll, level - roll, pitch, steer,
            _turned(distance / geometry.rear_radius), _turned(distance / geometry.front_radius),
            _turned(crank), _turned(crank) + pitch, _turned(crank) + pitch,
        ]  # fmt: skip
        mujoco.mj_kinematics(model, data)
        axes = data.xmat[self._frame].reshape(3, 3)
        for side, sign in _SIDES:
            self._put_leg(data, axes, side, sign)
            self._put_arm(data, axes, side, sign)
        mujoco.mj_kinematics(model, data)

    def _put_leg(self, data: mujoco.MjData, axes: Array, side: str, sign: int) -> None:
        hip, ankle = self._at(data, "hip", side), self._at(data, "ankle", side)
        hip = within_reach(hip, ankle, rider.THIGH + rider.SHANK)
        forward = axes @ np.array([1.0, sign * _KNEE_OUT, 0.3])
        knee = middle_joint(hip, ankle, rider.THIGH, rider.SHANK, forward)
        self._put(data, "thigh", side, hip, knee)
        self._put(data, "shank", side, knee, ankle)

    def _put_arm(self, data: mujoco.MjData, axes: Array, side: str, sign: int) -> None:
        shoulder, wrist = self._at(data, "shoulder", side), self._at(data, "wrist", side)
        shoulder = within_reach(shoulder, wrist, rider.UPPER_ARM + rider.FOREARM)
        outward = axes @ np.array([-0.45, sign * 0.50, -0.75])
        elbow = middle_joint(shoulder, wrist, rider.UPPER_ARM, rider.FOREARM, outward)
        self._put(data, "upper arm", side, shoulder, elbow)
        self._put(data, "forearm", side, elbow, wrist)

    def _at(self, data: mujoco.MjData, name: str, side: str) -> Array:
        return data.site_xpos[self._sites[name, side]].copy()

    def _put(self, data: mujoco.MjData, name: str, side: str, start: Array, end: Array) -> None:
        mocap = self._mocap[name, side]
        data.mocap_pos[mocap] = start
        mujoco.mju_mat2Quat(data.mocap_quat[mocap], bone_turn(start, end).ravel())


def _turned(angle: float) -> float:
    """Within one turn, for a steady picture far out."""
    return math.remainder(angle, 2 * math.pi)


def _set_chain(spec: mujoco.MjSpec, geometry: WheelGeometry) -> None:
    """The positions along the chain of bodies, and the tilt of the steer axis."""
    at = places(geometry)
    axle = np.array([0, 0, geometry.rear_radius])
    spec.body("frame").pos = axle
    spec.body("crank").pos = at.bottom_bracket
    half = geometry.tilt / 2
    spec.body("front").pos = at.fork
    spec.body("front").quat[:] = [math.cos(half), 0, -math.sin(half), 0]
    spec.body("front_wheel").pos = at.front_axle
    for side, sign in _SIDES:
        spec.body(f"pedal_{side}").pos[:] = [
            -sign * CRANK_LENGTH, sign * PEDAL_SIDE, 0
        ]  # fmt: skip
    sin, cos = math.sin(geometry.tilt), math.cos(geometry.tilt)
    x, _, z = at.grip
    grip = axle + at.fork + [cos * x - sin * z, 0, sin * x + cos * z]
    spec.body("eye").pos = grip + [-_EYE_BEHIND_GRIPS, 0, _EYE_OVER_GRIPS]


def _dress_bicycle(spec: mujoco.MjSpec, geometry: WheelGeometry) -> None:
    painted, bare = frame.rear_frame(geometry)
    _add(spec, "frame", "frame", painted, "gloss")
    _add(spec, "frame", "saddle and guard", bare)
    _add(spec, "frame", "chain", frame.chain(geometry))
    painted, bare = front.front_assembly(geometry)
    _add(spec, "front", "fork", painted, "gloss")
    _add(spec, "front", "bar", bare, "gloss")
    for name, radius in (("rear", geometry.rear_radius), ("front", geometry.front_radius)):
        tyre, bright = wheels.wheel(radius, rear=name == "rear")
        _add(spec, f"{name}_wheel", f"{name} tyre", tyre)
        _add(spec, f"{name}_wheel", f"{name} rim", bright, "gloss")
    _add(spec, "heading", "shade", wheels.shade(geometry), "shade")
    _add(spec, "crank", "cranks", frame.crank_set(), "gloss")
    pedal = frame.pedal()
    for side, _ in _SIDES:
        _add(spec, f"pedal_{side}", f"pedal {side}", pedal)


def _dress_rider(spec: mujoco.MjSpec, geometry: WheelGeometry) -> None:
    _add(spec, "frame", "trunk", rider.trunk(geometry), own=True)
    _add(spec, "frame", "head", rider.head(geometry), own=True)
    at = rider.joints(geometry)
    for side, sign in _SIDES:
        flip = np.array([1, sign, 1])
        hand = rider.hand(geometry)
        _add(spec, "front", f"hand {side}", hand if sign > 0 else hand.mirrored())
        _add(spec, f"pedal_{side}", f"shoe {side}", rider.shoe())
        for body, name, place in (
            ("frame", "hip", at.hip),
            ("frame", "shoulder", at.shoulder),
            ("front", "wrist", rider.wrist(geometry)),
            (f"pedal_{side}", "ankle", np.array(rider.ANKLE)),
        ):
            spec.body(body).add_site(name=f"{name} {side}", pos=(place * flip).tolist(), group=5)
        for name, shape, own in _LIMBS:
            spec.worldbody.add_body(name=f"{name} {side}", mocap=True)
            _add(spec, f"{name} {side}", f"{name} {side}", shape(), own=own)


def _add(
    spec: mujoco.MjSpec, body: str, name: str, mesh: Mesh, material: str = "matt", *,
    own: bool = False,
) -> None:  # fmt: skip
    """A mesh on a body; `own` is what the rider must not have before his eyes."""
    add_mesh(spec, name, mesh)
    look = spec.find_default("own body" if own else "bicycle")
    spec.body(body).add_geom(look, name=name, meshname=name, material=material)
