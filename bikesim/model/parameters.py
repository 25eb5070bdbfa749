"""The 25 parameters of a Whipple bicycle [M07, Table 1]."""

import math
from dataclasses import dataclass, fields

from bikesim.errors import InputError


@dataclass(frozen=True, slots=True)
class BicycleParameters:
    """A bicycle with a rigid rider: four rigid bodies and the geometry that joins them.

    Axes of [M07]: x forward, y right, z down, origin at the rear contact. SI units, radians.
    The inertia of B and H is about the body's centre of mass; that of a wheel about its axle,
    with Izz = Ixx. Raises InputError where a value is not finite or cannot belong to a bicycle.
    """

    w: float  # wheelbase [m]
    c: float  # trail [m]
    lam: float  # steer axis tilt from the vertical, backwards [rad]

    rR: float  # rear wheel radius [m]
    mR: float  # rear wheel mass [kg]
    IRxx: float  # rear wheel inertia about a diameter [kg m²]
    IRyy: float  # rear wheel inertia about the axle [kg m²]

    xB: float  # rear frame and rider, centre of mass [m]
    zB: float  # (negative: above the ground) [m]
    mB: float  # mass [kg]
    IBxx: float  # inertia [kg m²]
    IByy: float
    IBzz: float
    IBxz: float

    xH: float  # handlebar and fork, centre of mass [m]
    zH: float  # [m]
    mH: float  # [kg]
    IHxx: float  # [kg m²]
    IHyy: float
    IHzz: float
    IHxz: float

    rF: float  # front wheel radius [m]
    mF: float  # front wheel mass [kg]
    IFxx: float  # front wheel inertia about a diameter [kg m²]
    IFyy: float  # front wheel inertia about the axle [kg m²]

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise InputError(f"bicycle parameter {field.name} = {value}: must be finite")
        for name in _POSITIVE:
            if getattr(self, name) <= 0:
                raise InputError(
                    f"bicycle parameter {name} = {getattr(self, name)}: must be above 0"
                )
        for name in PARAMETER_NAMES:
            _check_size(name, getattr(self, name))
        if abs(self.lam) >= math.pi / 2:
            raise InputError(
                f"bicycle parameter lam = {self.lam}: the steer axis tilt is in radians, "
                "between -pi/2 and pi/2"
            )
        for name in ("zB", "zH"):
            if getattr(self, name) >= 0:
                raise InputError(
                    f"bicycle parameter {name} = {getattr(self, name)}: must be below 0 "
                    "(z points down, the ground is z = 0)"
                )
        for body in "BH":
            ixx, izz, ixz = (getattr(self, f"I{body}{axes}") for axes in ("xx", "zz", "xz"))
            if ixx * izz <= ixz * ixz:
                raise InputError(
                    f"bicycle parameter I{body}xz = {ixz}: with I{body}xx = {ixx} and "
                    f"I{body}zz = {izz} the inertia is not positive definite"
                )


def _check_size(name: str, value: float) -> None:
    least, most, unit = _SIZES["r" if name == "w" else name[0]]
    least = least if name in _POSITIVE else -most
    if not least <= value <= most:
        raise InputError(
            f"bicycle parameter {name} = {value}: must be from {least:g} to {most:g}{unit}"
        )


# By the first letter of a parameter: the least if it is positive, the most. Far beyond any bicycle.
_SIZES = {
    "m": (1e-3, 1e5, " kg"),
    "I": (1e-9, 1e6, " kg m²"),
    **dict.fromkeys("rcxz", (1e-3, 100.0, " m")),
    "l": (0.0, math.inf, ""),  # the tilt has limits of its own
}
# fmt: off
_POSITIVE = (
    "w", "rR", "rF", "mR", "mB", "mH", "mF",
    "IRxx", "IRyy", "IBxx", "IByy", "IBzz", "IHxx", "IHyy", "IHzz", "IFxx", "IFyy",
)
# fmt: on
PARAMETER_NAMES = tuple(field.name for field in fields(BicycleParameters))
