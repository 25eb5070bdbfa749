"""The MuJoCo model of a rig: mjcf/rig.xml with the figures of its settings."""

import math
from functools import lru_cache

import mujoco

from bikesim.data import data_path
from bikesim.errors import InputError
from bikesim.rider.base import Arms
from bikesim.rig.settings import RigSettings


def rig_spec() -> mujoco.MjSpec:
    """The drawing and mechanism as they ship, still to be changed. Raises InputError."""
    path = data_path("mjcf", "rig.xml")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None


@lru_cache(maxsize=512)
def rig_model(
    settings: RigSettings,
    *,
    inertia: float,
    arms: Arms,
    steer_axis_tilt: float,
    step: float,
    drawn: bool = False,
) -> mujoco.MjModel:
    """The compiled model of a rig. It is kept for who asks again: not to be changed.

    `inertia` I_δ [kg m²] is the total about the steer axis without the arms, motor rotor included;
    `arms` come on top of it. `steer_axis_tilt` [rad] of the bicycle, `step` [s] of the physics.
    It has the mechanism alone unless `drawn`: the same motion but for rounding, in less time.
    """
    if settings.rotor_inertia >= inertia:
        raise InputError(
            f"rig.rotor_inertia = {settings.rotor_inertia} kg m²: must be below the whole inertia "
            f"about the steer axis, {inertia:.6g} kg m²"
        )
    _check_step(step, arms.stiffness, inertia + arms.inertia)
    spec = rig_spec()
    if not drawn:
        _undress(spec)
    spec.option.timestep = step
    # A state that is not finite must reach the guard, not begin again at rest as if nothing was.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    half = steer_axis_tilt / 2
    spec.body("head").quat[:] = [math.cos(half), 0, -math.sin(half), 0]
    # Only the moment about the axis acts; three equal ones are always a possible inertia.
    spec.body("handlebar").inertia[:] = [inertia - settings.rotor_inertia] * 3

    joint = spec.joint("steer")
    joint.range[:] = [-settings.steer_stop, settings.steer_stop]
    joint.armature = settings.rotor_inertia + arms.inertia
    joint.damping[0] = settings.viscous_friction + arms.damping
    joint.stiffness[0] = arms.stiffness
    joint.frictionloss = settings.coulomb_friction

    _set_motor(spec.actuator("motor"), settings, step)
    for name in ("steer_angle", "steer_rate"):
        _set_sensor(spec.sensor(name), settings, step)
    try:
        return spec.compile()
    except ValueError as error:
        raise InputError(f"rig: MuJoCo refuses the model: {' '.join(str(error).split())}") from None


def _undress(spec: mujoco.MjSpec) -> None:
    drawing = (*spec.geoms, *spec.cameras, *spec.lights, spec.body("display"))
    for part in (*drawing, *spec.meshes, *spec.materials, *spec.textures):
        spec.delete(part)
    # The bodies that do not move become one: an eighth less time a step.
    spec.compiler.fusestatic = True


def _check_step(step: float, stiffness: float, inertia: float) -> None:
    """Half a radian of the arms' own oscillation a step: 1 % of its frequency (unstable at two)."""
    if stiffness * step**2 > 0.25 * inertia:
        longest = 0.5 * math.sqrt(inertia / stiffness)
        raise InputError(
            f"physics_step = {step} s: must be at most {longest:.2g} s for arms of "
            f"{stiffness:g} N m/rad on {inertia:.3g} kg m²"
        )


def _set_motor(motor: mujoco.MjsActuator, settings: RigSettings, step: float) -> None:
    if settings.torque_limit is not None:
        motor.forcelimited = True
        motor.forcerange[:] = [-settings.torque_limit, settings.torque_limit]
    if settings.motor_lag > 0:
        motor.dyntype = mujoco.mjtDyn.mjDYN_FILTEREXACT
        motor.dynprm[0] = settings.motor_lag
    motor.nsample = math.ceil(settings.motor_delay / step - 1e-9)
    motor.delay = motor.nsample * step


def _set_sensor(sensor: mujoco.MjsSensor, settings: RigSettings, step: float) -> None:
    steps = math.ceil(settings.sensor_delay / step - 1e-9)
    sensor.nsample = steps
    sensor.delay = steps * step
    if settings.sensor_interval > step:
        # MuJoCo adds up its time, and rounding moves a conversion that is due just at a step to the
        # step beside it, now and then. Half a step away from all steps it stays where it belongs.
        sensor.interval[:] = [settings.sensor_interval, -step / 2]
        sensor.delay = max(0.0, steps * step - step / 2)
        sensor.nsample = max(steps, 1)
