"""What a ride says of itself to those who look at it: all that a picture of it needs to begin with.

It stands in the screen's memory, so that a display asks nobody else and cannot disagree.
"""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bikesim import bicycles
from bikesim.bench.profile import BenchSettings
from bikesim.bicycles.toml_reader import bicycle_from_toml
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.path.building import make_path
from bikesim.path.in_sight import points_in_sight

_VERSION = 1
_FARTHEST = 20_000.0  # m of a path that are drawn; more would only fill the memory


@dataclass(frozen=True, eq=False)
class Showing:
    """`path` (n, 2) [m], x forward and y right, None: the line y = 0; the rest as in [vision].

    `haptics`: the law in words; `ramp_in` [s]: the torque grows to its own for so long.
    """

    bicycle: Bicycle
    path: NDArray[np.float64] | None
    roll_cue: bool
    preview: float | None
    delay: float
    occlusions: tuple[tuple[float, float], ...]
    haptics: str
    ramp_in: float

    def to_text(self) -> str:
        """JSON; places to the millimetre."""
        return json.dumps(
            {
                "version": _VERSION,
                "bicycle": bicycles.to_toml(self.bicycle),
                "path": None if self.path is None else self.path.round(3).tolist(),
                "roll_cue": self.roll_cue,
                "preview": self.preview,
                "delay": self.delay,
                "occlusions": self.occlusions,
                "haptics": self.haptics,
                "ramp_in": self.ramp_in,
            }
        )


def read_showing(text: str) -> Showing:
    """What `to_text` gave. Raises InputError where another version of this program wrote it."""
    try:
        said: Any = json.loads(text)
    except ValueError:
        said = None
    if not isinstance(said, dict) or said.pop("version", None) != _VERSION:
        raise InputError("the ride is of another version of bikesim, its display must be too")
    return Showing(
        bicycle=bicycle_from_toml(said.pop("bicycle"), name="", source=""),
        path=None if (path := said.pop("path")) is None else np.array(path),
        occlusions=tuple((first, last) for first, last in said.pop("occlusions")),
        **said,
    )


def showing_of(bench: BenchSettings, scenario: Scenario, bicycle: Bicycle) -> Showing:
    """Of a ride. Raises InputError for a path that no bicycle can ride."""
    vision, law = scenario.vision, scenario.law
    return Showing(
        bicycle=bicycle,
        path=points_in_sight(make_path(scenario.path), _distance(bench, scenario)),
        roll_cue=vision.roll_cue,
        preview=vision.preview,
        delay=vision.delay,
        occlusions=vision.occlusions,
        haptics="haptics off" if law == "off" else f"haptics on, law {law}",
        ramp_in=bench.thresholds.ramp_in,
    )


def _distance(bench: BenchSettings, scenario: Scenario) -> float:
    """That is ridden at most [m]."""
    speeds = [scenario.speed, *(speed for _, speed in scenario.speed_profile)]
    fastest = bench.limits.speed if bench.wheel is not None else max(speeds)
    return min(fastest * scenario.duration, _FARTHEST)
