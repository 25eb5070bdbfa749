"""Every figure of a rider that a user may set."""

from itertools import pairwise
from typing import Annotated, Any, ClassVar

from pydantic import Field, Strict, field_validator, model_validator

from bikesim.errors import InputError
from bikesim.rider.kinds import HUMAN_KEYS, GripName, is_custom, kind_of, script_kind
from bikesim.rider.script_settings import ScriptSettings
from bikesim.settings import Settings

_Gain = Annotated[float, Field(ge=-1e4, le=1e4)]
_Weight = Annotated[float, Field(ge=0, le=1e6)]
_Delay = Annotated[float, Field(ge=0, le=5)]
_Noise = Annotated[float, Field(ge=0, le=100)]
_Bandwidth = Annotated[float, Field(gt=0, le=1e4)]
_Damping = Annotated[float, Field(ge=0, le=1000)]
_Stiffness = Annotated[float, Field(ge=0, le=1e4)]
_Time = Annotated[float, Field(ge=0, le=86400)]
# TOML has lists, not tuples.
_List = Strict(False)
_Change = Annotated[tuple[_Time, GripName], _List]


class RiderSettings(Settings):
    """A virtual rider: a name, and every figure that a rider of that name has, the rest None.

    Made from a `name` alone it has the figures of the rider of that name; those given beside the
    name replace them.
    """

    table: ClassVar[str] = "rider"

    name: str = Field(
        default="human",
        description="human, pd, hands-off, hess2012, lqr, torque-KIND of a script, or "
        "schwab2013-RUN with the number of an identified run; or a class of your own, "
        "FILE.py:CLASS or package.module:CLASS.",
    )
    roll_gain: _Gain | None = Field(
        default=None, description="k_phi of human, pd and schwab2013 [N m/rad]."
    )
    roll_rate_gain: _Gain | None = Field(
        default=None, description="k_phi_dot of human, pd and schwab2013 [N m s/rad]."
    )
    steer_integral_gain: _Gain | None = Field(
        default=None, description="On the integral of the steer, of schwab2013 [N m/(rad s)]."
    )
    steer_rate_gain: _Gain | None = Field(
        default=None, description="k_delta_dot of schwab2013 [N m s/rad]."
    )
    k_delta: _Gain | None = Field(
        default=None,
        description="Of hess2012, steer [N m/rad]; "
        "default: as published, for the bicycle and the speed.",
    )
    k_phi_dot: _Gain | None = Field(
        default=None, description="Of hess2012, roll rate [s]; default: as published."
    )
    k_phi: _Gain | None = Field(
        default=None, description="Of hess2012, roll [1/s]; default: as published."
    )
    k_psi: _Gain | None = Field(
        default=None, description="Of hess2012, heading; default: as published."
    )
    k_y: _Gain | None = Field(
        default=None, description="Of hess2012, lateral position [rad/m]; default: as published."
    )
    lateral_weight: _Weight | None = Field(
        default=None, description="Of lqr, on the distance from the path [1/m²]; default: 1."
    )
    heading_weight: _Weight | None = Field(
        default=None, description="Of lqr, on the heading beside the path's [1/rad²]; default: 1."
    )
    effort_weight: Annotated[float, Field(gt=0, le=1e6)] | None = Field(
        default=None, description="Of lqr, on the torque [1/(N m)²]; default: 1."
    )
    preview_time: Annotated[float, Field(ge=0, le=60)] | None = Field(
        default=None,
        description="Of lqr, how far ahead he looks, in time of riding [s]; default: 3.",
    )
    script: ScriptSettings | None = Field(
        default=None, description="Table of the torque by the time, of torque-KIND; default: 1 N m."
    )
    figures: dict[str, float] | None = Field(
        default=None,
        description="Table of the figures of a class of your own; default: as the class has them.",
    )

    visual_delay: _Delay | None = Field(
        default=None, description="From seeing to intending [s]; published: 0.10 to 0.56."
    )
    vestibular_delay: _Delay | None = Field(default=None, description="Of the balance organs [s].")
    proprioceptive_delay: _Delay | None = Field(
        default=None, description="From feeling the bar to intending [s]."
    )
    vestibular_share: Annotated[float, Field(ge=0, le=1)] | None = Field(
        default=None,
        description="Of the perceived roll rate, what the balance organs tell, not the eyes: "
        "0 to 1; a rig that stands still gives them nothing.",
    )
    visual_roll_noise: _Noise | None = Field(
        default=None, description="On the roll that is seen, root mean square [rad]."
    )
    visual_roll_rate_noise: _Noise | None = Field(
        default=None, description="On the roll rate that is seen, root mean square [rad/s]."
    )
    visual_heading_noise: _Noise | None = Field(
        default=None, description="On the heading that is seen, root mean square [rad]."
    )
    visual_deviation_noise: _Noise | None = Field(
        default=None, description="On the distance from the path, root mean square [m]."
    )
    visual_noise_bandwidth: _Bandwidth | None = Field(
        default=None, description="Of the visual noises, corner of their spectra [rad/s]."
    )
    vestibular_noise: _Noise | None = Field(
        default=None,
        description="On the roll rate of the balance organs, root mean square [rad/s].",
    )
    vestibular_noise_bandwidth: _Bandwidth | None = Field(
        default=None, description="Corner of its spectrum [rad/s]."
    )
    proprioceptive_steer_noise: _Noise | None = Field(
        default=None, description="On the steer angle that is felt, root mean square [rad]."
    )
    proprioceptive_steer_rate_noise: _Noise | None = Field(
        default=None, description="On the steer rate that is felt, root mean square [rad/s]."
    )
    proprioceptive_noise_bandwidth: _Bandwidth | None = Field(
        default=None, description="Of both, corner of their spectra [rad/s]."
    )

    muscle_frequency: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None, description="Neuromuscular natural frequency [rad/s]."
    )
    muscle_damping_ratio: Annotated[float, Field(gt=0, le=10)] | None = Field(
        default=None, description="Neuromuscular damping ratio."
    )
    torque_limit: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        default=None, description="The most torque that he intends, each side [N m]; default: none."
    )
    remnant_rms: _Noise | None = Field(
        default=None, description="Torque noise, root mean square [N m]."
    )
    remnant_bandwidth: _Bandwidth | None = Field(
        default=None, description="Torque noise, corner of its spectrum [rad/s]."
    )
    arm_inertia: Annotated[float, Field(ge=0, le=10)] | None = Field(
        default=None, description="Arms about the steer axis [kg m²]."
    )
    arm_damping: _Damping | None = Field(
        default=None, description="Arms about the steer axis [N m s/rad]."
    )
    arm_stiffness: _Stiffness | None = Field(
        default=None, description="Arms about the steer axis [N m/rad]."
    )
    tight_damping: _Damping | None = Field(
        default=None, description="As arm_damping, of a tight grip [N m s/rad]."
    )
    tight_stiffness: _Stiffness | None = Field(
        default=None, description="As arm_stiffness, of a tight grip [N m/rad]."
    )
    grips: Annotated[tuple[_Change, ...], _List] | None = Field(
        default=None,
        description="Changes of grip: pairs of time [s] and hands-off, normal or tight; "
        "default: none.",
    )

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, given: Any) -> Any:
        if isinstance(given, str):
            given = {"name": given}
        if not isinstance(given, dict) or not isinstance(given.get("name", "human"), str):
            return given
        given = {key: value for key, value in given.items() if value is not None}
        name = given.get("name", "human")
        kind = kind_of(name)
        for key in given:
            if key in cls.model_fields and key not in ("name", *kind.keys):
                raise InputError(
                    f"rider.{key} = {given[key]!r}: rider {name} has no such figure; "
                    f"it has: {_told(kind.keys)}"
                )
        return _with_script({**kind.preset, **given})

    @field_validator("grips")
    @classmethod
    def _in_order(cls, grips: tuple[tuple[float, GripName], ...]) -> object:
        times = [time for time, _ in grips or ()]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError(f"times must rise from pair to pair, not {times}")
        return grips

    @property
    def custom(self) -> bool:
        """Whether it is a rider of the user's own."""
        return is_custom(self.name)


def _with_script(given: dict[str, Any]) -> dict[str, Any]:
    """The script of a scripted rider has the kind that his name says."""
    kind, script = script_kind(given.get("name", "")), given.get("script")
    if kind is None or not isinstance(script, dict):
        return given
    if script.get("kind", kind) != kind:
        raise InputError(
            f"rider.script.kind = {script['kind']!r}: of rider {given['name']} it is {kind!r}"
        )
    return {**given, "script": {**script, "kind": kind}}


def _told(keys: tuple[str, ...]) -> str:
    """Those of his brain by name; those of his body are many, and nearly all have them all."""
    own = ", ".join(key for key in keys if key not in HUMAN_KEYS) or "none"
    human = " of its own, and those of a body (bikesim rider list)"
    return own + (human if HUMAN_KEYS[-1] in keys else "")
