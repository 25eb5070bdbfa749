"""What is asked of an identification, and what it answers."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.identify.describing import DescribingFunction
from bikesim.identify.estimate import FREE_LAGS, Method
from bikesim.identify.ride import Ride
from bikesim.identify.structure import Lags, Structure, Vector

Free = Literal["free"]
"""In place of a figure: it is identified too."""

TorqueSource = Literal["rider", "bar"]


@dataclass(frozen=True)
class Question:
    """What is to be identified. What is None is as the structure or the records have it.

    `delay` [s], `muscle_frequency` [rad/s]; `arms` adds passive arms; `torque` is the channel
    rider_torque or that of the bar by eq. 5; `confidence` of the intervals.
    """

    structure: str = "schwab2013"
    arms: bool = False
    delay: float | Free | None = None
    muscle_frequency: float | Free | None = None
    muscle_damping_ratio: float | None = None
    method: Method | None = None
    torque: TorqueSource | None = None
    confidence: float = 0.95

    def __post_init__(self) -> None:
        for name, bounds in FREE_LAGS.items():
            value = getattr(self, name)
            least = max(bounds.least, 0.0)
            if not (value is None or value == "free" or least <= value <= bounds.most):
                raise InputError(f"{name} = {value}: free, or from {least:g} to {bounds.most:g}")
        ratio = self.muscle_damping_ratio
        if not (ratio is None or 0.05 <= ratio <= 10):
            raise InputError(f"muscle_damping_ratio = {ratio}: from 0.05 to 10")
        if not 0.5 <= self.confidence < 1:
            raise InputError(f"confidence = {self.confidence}: from 0.5 to below 1")


class IdentifiedGain(NamedTuple):
    """A gain with its interval; beside it what least squares gives, which is biased."""

    name: str
    unit: str
    value: float
    standard_error: float
    low: float
    high: float
    least_squares: float


class Fit(NamedTuple):
    """The torque of a ride, a mean a block [N m]; `modelled` by the signals as recorded."""

    time: Vector
    measured: Vector
    modelled: Vector


@dataclass(frozen=True, eq=False)
class Identification:
    """The answer. `vaf` [%] is the variance of the torque that the structure accounts for, by
    recorded signals; `noise_rms` [N m] what is left. `correlation` (k, k) of the gains' errors.

    `lines` counts the excited frequencies; it and `describing` are None without a known
    disturbance. `lags` are those held and those found.
    """

    question: Question
    structure: Structure
    method: Method
    torque: TorqueSource
    rides: tuple[Ride, ...]
    gains: tuple[IdentifiedGain, ...]
    lags: Lags
    free: tuple[str, ...]
    duration: float
    vaf: float
    least_squares_vaf: float
    noise_rms: float
    lines: int | None
    condition: float
    strength: float
    correlation: NDArray[np.floating[Any]]
    fits: tuple[Fit, ...]
    describing: DescribingFunction | None
    warnings: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """The keys of `bikesim identify rider --json`."""
        first = self.rides[0]
        return {
            "records": [ride.name for ride in self.rides],
            "bicycle": first.bicycle.name,
            "speed_m_s": first.speed,
            "law": first.law.value,
            "structure": self.structure.name,
            "method": self.method.value,
            "torque": self.torque,
            "duration_s": self.duration,
            "confidence": self.question.confidence,
            "gains": [gain._asdict() for gain in self.gains],
            "held": {
                name: value for name, value in self.lags._asdict().items() if name not in self.free
            },
            "vaf_percent": self.vaf,
            "least_squares_vaf_percent": self.least_squares_vaf,
            "noise_rms_N_m": self.noise_rms,
            "excited_frequencies": self.lines,
            "condition_number": self.condition,
            "instrument_strength": self.strength,
            "correlation": self.correlation.tolist(),
            "warnings": list(self.warnings),
        }
