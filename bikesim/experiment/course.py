"""Speed and disturbances of a scenario as the loop asks for them; of one, or of many at once."""

from collections.abc import Sequence

import numpy as np

from bikesim.experiment.moments import BLOCK, DisturbanceMoments
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.speed import SpeedProfile
from bikesim.loop import Moments
from bikesim.model.bicycle import Bicycle
from bikesim.model.real import Real

_NONE = Moments()


class ScenarioCourse:
    """A scenario's speed and disturbances by time [s]; a disturbance is the nearest tick's."""

    def __init__(self, scenario: Scenario, bicycle: Bicycle) -> None:
        self.speed = SpeedProfile(scenario)
        self._period = scenario.period
        self._disturbances = DisturbanceMoments(scenario, bicycle)
        self._block, self._moments = -1, [_NONE]

    def disturbance(self, time: float) -> Moments:
        """The generalised forces of all pushes and disturbances [N m]."""
        if self._disturbances.none:
            return _NONE
        block, tick = divmod(round(time / self._period), BLOCK)
        if block != self._block:
            rows = self._disturbances.block(block).T.tolist()
            self._block, self._moments = block, [Moments._make(row) for row in rows]
        return self._moments[tick]


class BatchCourse:
    """The courses of scenarios of one loop period and speed profile, as arrays (n,).

    Each has bit for bit what it has alone. What is equal for all is a float; while the speeds do
    not change they are the same object.
    """

    def __init__(self, scenarios: Sequence[Scenario], bicycle: Bicycle) -> None:
        first = scenarios[0]
        self._profile, self._period = SpeedProfile(first), first.period
        speeds = [one.speed for one in scenarios]
        self._speeds: Real = None
        if not first.speed_profile and len(set(speeds)) > 1:
            self._speeds = np.array(speeds)
        self._disturbances = [DisturbanceMoments(one, bicycle) for one in scenarios]
        self._none = all(one.none for one in self._disturbances)
        self._block, self._moments = -1, np.zeros((0, 2, 0))

    def speed(self, time: float) -> Real:
        """Forward speeds [m/s]."""
        return self._profile(time) if self._speeds is None else self._speeds

    def disturbance(self, time: float) -> Moments:
        """The generalised forces of all pushes and disturbances [N m]."""
        if self._none:
            return _NONE
        block, tick = divmod(round(time / self._period), BLOCK)
        if block != self._block:
            moments = np.stack([one.block(block) for one in self._disturbances])
            self._block, self._moments = block, np.zeros(moments.shape[::-1])
            if moments.any():
                self._moments[:] = moments.transpose(2, 1, 0)
        roll, steer = self._moments[tick]
        return Moments(roll, steer)
