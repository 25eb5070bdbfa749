"""What a picture takes from the scenario of a record; a record may come without one."""

import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.path.building import make_path
from bikesim.path.in_sight import points_in_sight
from bikesim.path.settings import PathSettings

if TYPE_CHECKING:
    from bikesim.record.reader import Run


class Shown:
    """The scenario of a run, as far as it is drawn."""

    def __init__(self, run: "Run") -> None:
        self._run = run
        try:
            self._tables = tomllib.loads(run.scenario)
        except tomllib.TOMLDecodeError:
            self._tables = {}

    @property
    def torque_limit(self) -> float | None:
        """The smaller of the guard's limit and the rig's [N m]."""
        limits = [self._table(name).get("torque_limit") for name in ("guard", "rig")]
        numbers = (float(limit) for limit in limits if isinstance(limit, int | float))
        return min(numbers, default=None)

    @property
    def roll_cue(self) -> bool:
        """Whether the rider saw the roll."""
        return self._table("vision").get("roll_cue") is not False

    def path(self, distance: float) -> NDArray[np.float64] | None:
        """The prescribed path, (n, 2) [m], x forward and y right, for a ride of a `distance` [m].

        None is the line y = 0. Raises InputError for a path that cannot be read.
        """
        try:
            path = make_path(PathSettings(**self._table("path")))
        except InputError as error:
            raise InputError(f"{self._run.path}: its scenario: {error}") from None
        return points_in_sight(path, distance)

    def _table(self, name: str) -> dict[str, Any]:
        table = self._tables.get(name)
        return table if isinstance(table, dict) else {}
