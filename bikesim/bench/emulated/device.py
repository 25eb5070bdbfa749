"""What an emulated device is: a state machine that frames and time go into, and frames come of."""

from typing import Protocol

from bikesim.bench.frame import Frame


class Device(Protocol):
    """Something on the bus. Time [s] never goes back; it starts anywhere."""

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        """What it sends in answer to a frame; frames for others give nothing."""
        ...

    def advance(self, time: float) -> list[Frame]:
        """What it sends by itself until `time`."""
        ...


class DriveDevice(Device, Protocol):
    """A drive: the bench sets its shaft's `angle` [rad] and `rate` [rad/s], mishaps the rest.

    `strength`: what share of the torque that it is told its motor gives; `offset` [N m]: what it
    measures beside that.
    """

    angle: float
    rate: float
    strength: float
    offset: float

    @property
    def torque(self) -> float:
        """That acts on the shaft [N m]."""
        ...

    def disable(self) -> None:
        """By itself, without an error."""
        ...

    def stay_in_mode(self, mode: int | None) -> None:
        """Of operation, by its number, whatever it is told; None: as it is told from now on."""
        ...

    def break_down(self) -> None:
        """An error of its own, as of a short circuit: the motor is free."""
        ...

    def command_of_another(self) -> Frame:
        """What another host would send it: no torque, and it stays enabled."""
        ...


class Periodic:
    """Says when something that happens every `period` [s] is due; 0: never.

    What was missed by more than a period is not made up for.
    """

    def __init__(self, period: float) -> None:
        self.period = period
        self._next: float | None = None

    def due(self, time: float) -> bool:
        """Whether it is due now; then it is due again a period later."""
        if self.period <= 0:
            return False
        if self._next is None:
            self._next = time
        # A tenth of a millionth: a sum of periods is not exact.
        if time < self._next - 1e-7:
            return False
        late = time - self._next
        self._next = self._next + self.period if late < self.period else time + self.period
        return True
