"""Time as the loop sees it. Simulated here; the bench's real time will stand beside it."""


class SimulatedClock:
    """Time that passes when it is told to, in whole periods [s], without accumulated rounding."""

    def __init__(self, period: float) -> None:
        self._period = period
        self._ticks = 0
        self.now = 0.0

    def advance(self) -> None:
        """One period on."""
        self._ticks += 1
        self.now = self._ticks * self._period
