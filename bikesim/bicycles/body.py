"""The rider's part of the rear frame, and the rear frame B with that rider in it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

from bikesim.errors import InputError
from bikesim.model.parameters import BicycleParameters

BODY_KEYS = ("mB", "xB", "zB", "IBxx", "IByy", "IBzz", "IBxz")


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body symmetric about the plane y = 0, in the axes of [M07].

    Mass `m` [kg], centre of mass `x`, `z` [m], inertia about it [kg m²]. `Ixz` is the element of
    the inertia matrix, -∫ x z dm. Raises InputError where that can be no body.
    """

    m: float
    x: float
    z: float
    Ixx: float
    Iyy: float
    Izz: float
    Ixz: float

    def __post_init__(self) -> None:
        for key in BODY_KEYS:
            if not math.isfinite(self._value(key)):
                raise InputError(f"rider: {key} = {self._value(key)}: must be finite")
        if self.m <= 0:
            raise InputError(f"rider: mB = {self.m}: must be above 0 kg")
        for key in ("IBxx", "IByy", "IBzz"):
            if self._value(key) < 0:
                raise InputError(f"rider: {key} = {self._value(key)}: must not be below 0")
        if self.Ixz**2 > self.Ixx * self.Izz:
            raise InputError(f"rider: IBxz = {self.Ixz}: no body has this with its IBxx and IBzz")

    def _value(self, key: str) -> float:
        return getattr(self, key.replace("B", ""))

    @classmethod
    def from_values(cls, values: Mapping[str, float]) -> Self:
        """The body of the seven values named `BODY_KEYS`."""
        return cls(*(values[key] for key in BODY_KEYS))

    @classmethod
    def rear_frame(cls, p: BicycleParameters) -> Self:
        """Body B of a bicycle."""
        return cls(*(getattr(p, key) for key in BODY_KEYS))

    def joined(self, other: Self) -> Self:
        """Both as one body: parallel axes, about the common centre of mass."""
        m = self.m + other.m
        x = (self.m * self.x + other.m * other.x) / m
        z = (self.m * self.z + other.m * other.z) / m
        parts = [(body, body.x - x, body.z - z) for body in (self, other)]
        return type(self)(
            m=m,
            x=x,
            z=z,
            Ixx=sum(b.Ixx + b.m * dz**2 for b, _, dz in parts),
            Iyy=sum(b.Iyy + b.m * (dx**2 + dz**2) for b, dx, dz in parts),
            Izz=sum(b.Izz + b.m * dx**2 for b, dx, _ in parts),
            Ixz=sum(b.Ixz - b.m * dx * dz for b, dx, dz in parts),
        )


def with_rider(parameters: BicycleParameters, rider: RigidBody) -> BicycleParameters:
    """The bicycle with a rigid rider on its rear frame."""
    body = RigidBody.rear_frame(parameters).joined(rider)
    return replace(
        parameters,
        mB=body.m,
        xB=body.x,
        zB=body.z,
        IBxx=body.Ixx,
        IByy=body.Iyy,
        IBzz=body.Izz,
        IBxz=body.Ixz,
    )
