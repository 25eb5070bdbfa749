"""Whoever takes frames off the bus."""

from typing import Protocol

from bikesim.bench.frame import Frame


class Traffic(Protocol):
    """Takes the frames of some identifiers as they come."""

    @property
    def ids(self) -> frozenset[int]: ...

    def receive(self, frame: Frame, time: float) -> None:
        """A frame, at a time [s] of the loop's clock."""
        ...
