"""Which riders there are: each a name, the class of its brain, and the figures it has."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

from bikesim.errors import InputError, unknown
from bikesim.rider.script_settings import SCRIPT_KINDS

GripName = Literal["hands-off", "normal", "tight"]

# What makes a rider human, whatever his brain: the keys of RiderSettings, by what they are of.
# Not there by default: the noise of the senses, a limit, changes of grip.
_SENSES: dict[str, Any] = {
    "visual_delay": 0.0,
    "vestibular_delay": 0.0,
    "proprioceptive_delay": 0.0,
    "vestibular_share": 0.0,
    "visual_roll_noise": 0.0,
    "visual_roll_rate_noise": 0.0,
    "visual_heading_noise": 0.0,
    "visual_deviation_noise": 0.0,
    "visual_noise_bandwidth": 10.0,
    "vestibular_noise": 0.0,
    "vestibular_noise_bandwidth": 10.0,
    "proprioceptive_steer_noise": 0.0,
    "proprioceptive_steer_rate_noise": 0.0,
    "proprioceptive_noise_bandwidth": 10.0,
}
_MUSCLE_H12 = {"muscle_frequency": 30.0, "muscle_damping_ratio": 0.707}  # [H12]
# [S13]: ω = 2π 2.17 rad/s, ζ = 1/√2.
_MUSCLE_S13 = {"muscle_frequency": 13.634512116579973, "muscle_damping_ratio": 0.7071067811865476}
_NO_ARMS = {"arm_inertia": 0.0, "arm_damping": 0.0, "arm_stiffness": 0.0}
_NO_NOISE = {"remnant_rms": 0.0, "remnant_bandwidth": 10.0}
_ACTING: dict[str, Any] = {
    **_MUSCLE_H12,
    "torque_limit": None,
    **_NO_NOISE,
    **_NO_ARMS,
    "tight_damping": 10.0,
    "tight_stiffness": 200.0,
    "grips": (),
}
HUMAN_KEYS = (*_SENSES, *_ACTING)

# Arms and delay of the case that separates best: haptics on a roll PD balances, off none does
# (docs/paper.md). The gains are for the benchmark bicycle at 3.5 m/s: those with the least roll for
# a given remnant, which is chosen so that this roll is about 2 degrees RMS.
_HUMAN = {
    "roll_gain": 0.43,
    "roll_rate_gain": 1.74,
    **_SENSES,
    "visual_delay": 0.2,
    **_ACTING,
    "arm_inertia": 0.1,
    "arm_damping": 2.0,
    "arm_stiffness": 5.0,
    "remnant_rms": 0.03,
}
# The same arms, without delay and noise, for a researcher to start from; at home there too.
_PD = {**_HUMAN, "roll_gain": 3.0, "roll_rate_gain": 5.0, "visual_delay": 0.0, **_NO_NOISE}
_ONE_OF_OURS = {**_SENSES, **_ACTING}
# Nothing human but what he is given: no delay, no lag, no noise, no arms.
_BARE = {**_ONE_OF_OURS, "muscle_frequency": None}
_IDENTIFIED = "schwab2013-"
_SCRIPTED = "torque-"
_ABOUT_S13 = "as identified from a person on the davis bicycle [S13]"


class Kind(NamedTuple):
    """A kind of rider: `brain` as module:class, its `figures`, a `preset` for all his keys.

    `figures` are keys of RiderSettings that the class takes as keywords of the same name; one that
    is None is left to the class. Some may be human ones that the brain wants to know too.
    """

    brain: str
    figures: tuple[str, ...]
    preset: Mapping[str, Any]
    about: str

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that a rider of this kind has."""
        return tuple(self.preset)


class Described(NamedTuple):
    """A rider as he is listed: his name, what he does, the figures of his brain by their keys.

    A figure that is None is left to his class, for a reason of its own.
    """

    name: str
    about: str
    figures: dict[str, Any]


def described() -> list[Described]:
    """All riders by name."""
    found = []
    for name in rider_names():
        kind = kind_of(name)
        own = {key: value for key, value in kind.preset.items() if key not in HUMAN_KEYS}
        found.append(Described(name, kind.about, own))
    return found


def rider_names() -> tuple[str, ...]:
    """Every rider's name; the identified ones by run number."""
    from bikesim.rider.schwab2013 import IDENTIFIED_RUNS

    return (*_NAMED, *(f"{_IDENTIFIED}{run.run}" for run in IDENTIFIED_RUNS))


def identified_run(name: str) -> int | None:
    """The run number in the name of an identified rider, else None."""
    number = name.removeprefix(_IDENTIFIED)
    return int(number) if name.startswith(_IDENTIFIED) and number.isdecimal() else None


def script_kind(name: str) -> str | None:
    """The kind of script in the name of a scripted rider, else None."""
    kind = name.removeprefix(_SCRIPTED)
    return kind if name.startswith(_SCRIPTED) and kind in SCRIPT_KINDS else None


def is_custom(name: str) -> bool:
    """Whether it is a rider of the user's own: FILE.py:CLASS or package.module:CLASS."""
    return ":" in name


def kind_of(name: str) -> Kind:
    """The kind of a rider by his name. Raises InputError."""
    if is_custom(name):
        return CUSTOM
    if name.endswith(".py"):
        raise InputError(f"rider.name = {name!r}: must name the class too, as in {name}:MyRider")
    if name in _NAMED:
        return _NAMED[name]
    if identified_run(name) is not None and name in rider_names():
        return _identified(name)
    raise unknown("rider", name, rider_names())


def _identified(name: str) -> Kind:
    from bikesim.rider.schwab2013 import IDENTIFIED_RUNS

    run = next(run for run in IDENTIFIED_RUNS if name == f"{_IDENTIFIED}{run.run}")
    gains = {
        "roll_gain": run.roll,
        "roll_rate_gain": run.roll_rate,
        "steer_integral_gain": run.steer_integral,
        "steer_rate_gain": run.steer_rate,
    }
    preset = {**gains, **_ONE_OF_OURS, **_MUSCLE_S13}
    return Kind("bikesim.rider.schwab2013:IdentifiedRider", tuple(gains), preset, _ABOUT_S13)


CUSTOM = Kind("", (), {"figures": {}, **_BARE}, "yours")
_ROLL_PD = ("roll_gain", "roll_rate_gain")
_HESS = ("k_delta", "k_phi_dot", "k_phi", "k_psi", "k_y")
_LQR = {
    "lateral_weight": 1.0,
    "heading_weight": 1.0,
    "effort_weight": 1.0,
    "preview_time": 3.0,
}
# What the optimal rider knows of himself.
_OWN_BODY = tuple({**_MUSCLE_H12, **_NO_ARMS})
_SCRIPT = Kind(
    "bikesim.rider.scripted:Scripted",
    ("script",),
    {"script": {}, **{key: value for key, value in _BARE.items() if key not in _SENSES}},
    "a torque by the clock, whatever the bicycle does",
)
_NAMED = {
    "human": Kind(
        "bikesim.rider.roll_pd:RollPD",
        _ROLL_PD,
        _HUMAN,
        "steers by roll and roll rate, late and with noise; for the benchmark bicycle at 3.5 m/s",
    ),
    "pd": Kind("bikesim.rider.roll_pd:RollPD", _ROLL_PD, _PD, "the same without delay and noise"),
    "hands-off": Kind("bikesim.rider.hands_off:HandsOff", (), {}, "nobody at the bar"),
    "hess2012": Kind(
        "bikesim.rider.hess2012:Hess2012",
        _HESS,
        {**dict.fromkeys(_HESS), **_ONE_OF_OURS},
        "five loops, follows a path [H12]",
    ),
    "lqr": Kind(
        "bikesim.rider.lqr:Lqr",
        (*_LQR, *_OWN_BODY),
        {**_LQR, **_ONE_OF_OURS},
        "optimal, follows a path with preview",
    ),
    **{f"{_SCRIPTED}{kind}": _SCRIPT for kind in SCRIPT_KINDS},
}
