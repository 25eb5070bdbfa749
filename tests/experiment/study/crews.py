"""Workers to test with: in this process, and of whatever luck the test wants."""

from collections.abc import Callable, Sequence

from bikesim.experiment.study.crew import Answered, Event, Lost
from bikesim.experiment.study.work import Order, Ride, work


class OwnHands:
    """Does one order at a time in this process; `lose` says which batches kill their worker."""

    def __init__(self, lose: Callable[[int, int], bool] = lambda batch, turn: False) -> None:
        self._lose, self._order = lose, None
        self.turns: list[int] = []

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None: ...

    workers = 1

    @property
    def free(self) -> int:
        return int(self._order is None)

    @property
    def busy(self) -> int:
        return int(self._order is not None)

    progress = 0.0

    def give(self, order: Order) -> None:
        assert self._order is None
        self._order = order

    def wait(self, seconds: float) -> Sequence[Event]:
        del seconds
        order, self._order = self._order, None
        assert order is not None
        number = order.batch.number if isinstance(order, Ride) else 0
        turn = self.turns.count(number)
        self.turns.append(number)
        if self._lose(number, turn):
            return [Lost(order, "signal SIGKILL")]
        return [Answered(order, work(order, lambda _: False), "own-hands")]

    def stop(self) -> None:
        """Nobody else is at work."""
