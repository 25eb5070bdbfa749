"""A bicycle as the simulator needs it: matrices, the geometry of eq. 8, gravity."""

import math
from dataclasses import dataclass, replace
from typing import Self

from bikesim.errors import InputError
from bikesim.model.parameters import BicycleParameters
from bikesim.model.whipple import Matrices, whipple_matrices


@dataclass(frozen=True, eq=False)
class Bicycle:
    """A bicycle with its rigid rider, by its parameters or by its matrices alone.

    `wheelbase` and `trail` [m] and `steer_axis_tilt` [rad] are those of eq. 8; `gravity` [m/s²].
    `source` says where the figures come from. `parameters` is None for a bicycle that is known
    by its matrices only. Raises InputError for a value out of range.
    """

    name: str
    source: str
    matrices: Matrices
    wheelbase: float
    trail: float
    steer_axis_tilt: float
    gravity: float = 9.81
    parameters: BicycleParameters | None = None

    def __post_init__(self) -> None:
        if not self.wheelbase > 0 or not math.isfinite(self.wheelbase):
            raise InputError(f"bicycle {self.name}: wheelbase = {self.wheelbase}: must be above 0")
        if not math.isfinite(self.trail):
            raise InputError(f"bicycle {self.name}: trail = {self.trail}: must be finite")
        if not 1e-3 <= self.wheelbase <= 100:
            raise InputError(
                f"bicycle {self.name}: wheelbase = {self.wheelbase}: from 0.001 to 100 m"
            )
        if abs(self.trail) > 100:
            raise InputError(f"bicycle {self.name}: trail = {self.trail}: from -100 to 100 m")
        if not abs(self.steer_axis_tilt) < math.pi / 2:
            raise InputError(
                f"bicycle {self.name}: steer axis tilt = {self.steer_axis_tilt}: "
                "in radians, between -pi/2 and pi/2"
            )
        if not 0 <= self.gravity < 100:
            raise InputError(f"bicycle {self.name}: gravity = {self.gravity}: from 0 to 100 m/s²")

    @classmethod
    def from_parameters(
        cls, parameters: BicycleParameters, *, name: str, source: str, gravity: float = 9.81
    ) -> Self:
        """The bicycle of these 25 parameters."""
        return cls(
            name=name,
            source=source,
            matrices=whipple_matrices(parameters),
            wheelbase=parameters.w,
            trail=parameters.c,
            steer_axis_tilt=parameters.lam,
            gravity=gravity,
            parameters=parameters,
        )

    def with_gravity(self, gravity: float) -> Self:
        """The same bicycle under another gravity [m/s²]."""
        return replace(self, gravity=gravity)
