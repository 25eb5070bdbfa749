"""A motor drive as the loop has it: frames in, a torque out, and how it is."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple, Protocol

from bikesim.bench.finding import Finding
from bikesim.bench.frame import Frame

if TYPE_CHECKING:
    import can


class DriveView(NamedTuple):
    """How a drive is at a tick; at the steer axis, SI, right positive.

    `age` [s] of `steer` and `steer_rate`, of the older where they come in two messages;
    `silent` [s]: for how long it has owed one of its cyclic messages, the one that is missing
    longest: since it was due, or asked for; `heartbeat_age` [s]. `trouble` says why it is not
    enabled in torque mode, `error` what it reported, both empty where all is well. `torque`, as it
    measures it [N m];
    `steer` [rad] from where its encoder has its zero, `steer_rate` [rad/s].
    """

    age: float
    silent: float
    heartbeat_age: float
    enabled: bool
    trouble: str
    error: str
    torque: float
    steer: float
    steer_rate: float


class Cyclic(NamedTuple):
    """A message that a drive sends by itself or at each tick: identifier, name, `rate` [1/s]."""

    id: int
    name: str
    rate: float


class Drive(Protocol):
    """A drive on the bus. In the loop it never waits and never raises."""

    @property
    def name(self) -> str: ...

    @property
    def heartbeat_period(self) -> float:
        """Between two of the drive's heartbeats [s]."""
        ...

    @property
    def watchdog_timeout(self) -> float:
        """The host silent for so long [s]: the drive disables itself."""
        ...

    @property
    def ids(self) -> frozenset[int]:
        """Of the frames that it sends."""
        ...

    @property
    def host_ids(self) -> frozenset[int]:
        """Of the frames that only its host may send."""
        ...

    def traffic(self, period: float) -> Iterable[tuple[int, float]]:
        """Bytes of data and times a second of all its frames, at a loop `period` [s]."""
        ...

    def cyclic(self, period: float) -> Iterable[Cyclic]:
        """What it sends cyclically, at a loop `period` [s], while it is disabled too."""
        ...

    def set_up(self, bus: "can.BusABC", *, prove: bool = True) -> tuple[str, ...]:
        """Checks it against its profile, sets it up and proves its watchdog; lines for a person.

        It is disabled afterwards, and if this raises InputError. Without `prove` it is never
        enabled, and may not be before it was proven.
        """
        ...

    def receive(self, frame: Frame, time: float) -> None:
        """A frame of its own, at a time [s]."""
        ...

    def command(
        self, torque: float, *, enable: bool, on_time: bool = True
    ) -> tuple[list[Frame], float]:
        """The frames of a tick for a torque [N m] at the steer axis, and what they mean of it.

        A tick that is not on time feeds no watchdog, unless it is with a torque of zero.
        """
        ...

    def upkeep(self, time: float, *, on_time: bool = True) -> list[Frame]:
        """What goes out after the command at a time [s]: asks for data, feeds the watchdog."""
        ...

    def farewell(self) -> list[Frame]:
        """Zero torque and disabled."""
        ...

    def findings(self) -> Iterable[Finding]:
        """State, mode, error and units for `bench check`: it was set up, is disabled, and all
        that it sent since was received.
        """
        ...

    def view(self, time: float) -> DriveView:
        """How it is at a time [s]."""
        ...
