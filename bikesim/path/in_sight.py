"""The part of a path that a rider may come to see, as points to draw."""

from bikesim.path.path import Array, Path, path_points

_IN_SIGHT = 400.0  # m of the path before its begin and beyond its end, or the bicycle's
_APART = 0.5  # m


def points_in_sight(path: Path, distance: float) -> Array | None:
    """The path, (n, 2) [m], x forward and y right, for a ride of a `distance` [m].

    None is the line y = 0.
    """
    if path.straight:
        return None
    end = path.length if path.closed else max(path.length, distance) + _IN_SIGHT
    return path_points(path, -_IN_SIGHT, end, _APART)
