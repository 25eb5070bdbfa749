"""How a rider holds the bar: his arms, and whether his hands are on it."""

from collections.abc import Sequence

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.base import Arms
from bikesim.rider.kinds import GripName
from bikesim.rider.schedule import Schedule

_OFF, _NORMAL, _TIGHT = 0.0, 1.0, 2.0
_KINDS: dict[str, float] = {"hands-off": _OFF, "normal": _NORMAL, "tight": _TIGHT}


class Grip:
    """The grip by the time: `arms`, who is `holding`, and who has just been `taking` the bar.

    The last two are True, False, or a mask (n,). `normal` and `tight` arms; off the bar there are
    none. `each`: the changes of each rider of a batch, or of the one, as pairs of time [s] and
    kind.
    """

    def __init__(
        self, normal: Arms, tight: Arms, each: Sequence[Sequence[tuple[float, GripName]]]
    ) -> None:
        self._normal, self._tight = normal, tight
        changes = [[(time, _KINDS[kind]) for time, kind in one] for one in each]
        self._kind_at = Schedule(_NORMAL, changes)
        self._kind: Real = _NORMAL
        self.arms = normal
        self.holding: Real = True
        self.taking: Real = False

    def changed(self, time: float) -> bool:
        """Whether it is another one at this time [s], which must not fall from call to call."""
        kind = self._kind_at(time)
        if kind is self._kind:
            return False
        self.holding = kind != _OFF
        self.taking = self.holding & (self._kind == _OFF)
        self._kind = kind
        self.arms = Arms(*map(self._figure, self._normal, self._tight))
        return True

    def _figure(self, normal: Real, tight: Real) -> Real:
        figure = np.where(self._kind == _TIGHT, tight, np.where(self.holding, normal, 0.0))
        return figure if figure.ndim else float(figure)
