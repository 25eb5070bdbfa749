"""What a scenario's [vision] lets the rider see of the bicycle: later, or nothing for a while."""

from collections import deque
from collections.abc import Sequence

from bikesim.view.pose import Pose


class Eyes:
    """Poses as they come → the pose to be shown; None: the display is dark.

    As for a virtual rider: what is shown is `delay` [s] old, linear between the poses that came,
    and it is dark where that falls into one of the `occlusions`, from and to [s].
    """

    def __init__(self, delay: float, occlusions: Sequence[tuple[float, float]]) -> None:
        self._delay = delay
        self._occlusions = occlusions
        self._past: deque[Pose] = deque()

    def see(self, pose: Pose) -> Pose | None:
        """Of poses whose times do not fall, but where a bicycle begins anew."""
        if self._past and pose.time < self._past[-1].time:
            self._past.clear()
        shown = self._late(pose) if self._delay else pose
        dark = any(first <= shown.time < last for first, last in self._occlusions)
        return None if dark else shown

    def _late(self, pose: Pose) -> Pose:
        past, time = self._past, pose.time - self._delay
        if past and past[-1].time == pose.time:
            past.pop()
        past.append(pose)
        # One at or before the time is kept, of which and the next the pose is made.
        while len(past) > 1 and past[1].time <= time:
            past.popleft()
        before, after = past[0], past[min(1, len(past) - 1)]
        if after.time <= before.time or time <= before.time:
            return before
        share = (time - before.time) / (after.time - before.time)
        return Pose(*(a + share * (b - a) for a, b in zip(before, after, strict=True)))
