"""A path from its settings."""

from functools import lru_cache
from typing import Any

from bikesim.path import kinds
from bikesim.path.path import Path, straight_path
from bikesim.path.settings import PathSettings
from bikesim.path.spline import path_along


def make_path(settings: PathSettings) -> Path:
    """The path of resolved settings. Raises InputError if no bicycle can ride it."""
    kept: Any = settings  # frozen, so it has a hash
    return _made(kept)


@lru_cache(maxsize=32)
def _made(settings: PathSettings) -> Path:
    s: Any = settings  # the figures that a kind has are not None
    match settings.kind:
        case "lane-change":
            path = kinds.lane_change(s.start, s.offset, s.length, s.back, s.hold)
        case "double-lane-change":
            path = kinds.double_lane_change(s.start, s.offset, s.length, s.hold, s.return_length)
        case "slalom":
            path = kinds.slalom(s.start, s.amplitude, s.wavelength, s.count)
        case "circle":
            path = kinds.circle(s.start, s.radius, s.side, s.entry)
        case "figure-eight":
            path = kinds.figure_eight(s.start, s.radius, s.side)
        case "csv":
            path = path_along(s.points)
        case _:
            path = straight_path()
    return path
