"""What is to be seen of a bus: a ride on it, one that is over or fell silent, or none yet."""

from enum import Enum
from typing import NamedTuple

from bikesim.bench.display import ScreenReader
from bikesim.bench.showing import Showing, read_showing
from bikesim.model.haptic import BicycleState

SILENT = 1.0
"""Without a new state for so long [s], what was seen last must not be shown as if it were live."""


class Phase(Enum):
    """Of a ride as it looks from outside."""

    NONE = "there was none yet"
    READY = "not begun"
    RIDING = "riding"
    SILENT = "its states stopped coming"
    OVER = "over"


class Sight(NamedTuple):
    """`state`: the newest, None before the first; `words`: what the ride said last.

    `silence` [s]: since when there is nothing new; `alive`: whether the ride's process runs.
    """

    phase: Phase
    state: BicycleState | None
    words: str
    silence: float
    alive: bool


class Onlooker:
    """Looks at a bus's screen, ride after ride."""

    def __init__(self, reader: ScreenReader) -> None:
        self._reader = reader
        self.showing: Showing | None = None
        """What the ride said of itself: another object for another ride."""
        self._ride: int | None = None
        self._count = 0
        self._changed = 0.0
        self._state: BicycleState | None = None

    def look(self, now: float) -> Sight:
        """At a time [s] that rises. Raises InputError for a ride of another version."""
        seen = self._reader.look()
        ride = self._reader.ride
        if ride is not None and ride != self._ride:
            self.showing = read_showing(self._reader.about)
            self._ride, self._count, self._state, self._changed = ride, 0, None, now
        if seen is not None and seen[0] != self._count:
            (self._count, self._state), self._changed = seen, now
        elif seen is None and self._count and self._reader.standing:
            self._count, self._state, self._changed = 0, None, now
        alive = self._reader.alive
        silence = now - self._changed
        phase = self._phase(silence, here=ride is not None, alive=alive)
        return Sight(phase, self._state, self._reader.words, silence, alive)

    def _phase(self, silence: float, *, here: bool, alive: bool) -> Phase:
        if self._ride is None:
            return Phase.NONE
        if not here:
            return Phase.OVER
        if self._state is None:
            return Phase.READY if alive else Phase.SILENT
        return Phase.RIDING if silence < SILENT else Phase.SILENT
