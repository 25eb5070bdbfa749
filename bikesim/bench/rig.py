"""The bench: a real handlebar on a CAN bus, with a person's hands on it; a `Rig` like any other."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple, Protocol

from bikesim.bench.drive import Drive, DriveView
from bikesim.bench.faults import Observation
from bikesim.bench.frame import Frame
from bikesim.bench.senses import Bar, BarView
from bikesim.bench.traffic import Traffic
from bikesim.clock import Wake
from bikesim.model.haptic import BicycleState
from bikesim.record.channels import Channel
from bikesim.rig.base import RigInfo, Sample

BENCH_CHANNELS = (
    Channel("sample_age", "s", ">= 0", "age of the newest good sensor sample at the tick"),
    Channel("sample_time", "s", "the node's clock", "when the sensor node took that sample"),
    Channel("frames_lost", "1", "in all", "sensor frames missing up to now"),
    Channel("drive_age", "s", ">= 0", "age of the drive's position and speed at the tick"),
    Channel("drive_enabled", "1", "0 or 1", "whether the drive was enabled, in torque mode"),
    Channel("motor_torque", "N m", "> 0 turns right", "torque as the drive measures it"),
    Channel("fault", "1", "row of the table", "fault that the guard saw in this tick; 0: none"),
    Channel("late", "s", ">= 0", "how late the tick began, after the deadline it was to meet"),
    Channel("skipped", "1", "in all", "ticks left out because they were past, up to now"),
)

# A tick takes no more; a bus that is flooded must not hold it up.
_MOST_FRAMES = 64

# Of the measured time [1/s], a power of two: steps between ticks are then exact numbers, of which a
# few hundred come again and again, and the law's coefficients for them are at hand.
_RESOLUTION = 2.0**20

# Of the farewell: in all, and from one to the next [s]; how often at least.
_PATIENCE, _BETWEEN, _LEAST = 0.05, 0.005, 2


class Port(Protocol):
    """The bus as the loop sees it; never waits longer than told, and says what failed."""

    @property
    def trouble(self) -> str:
        """What is wrong with the bus; empty where nothing is."""
        ...

    @property
    def wakes_late(self) -> float:
        """By how much a wait for frames may be longer than it should [s]."""
        ...

    def send(self, frames: Iterable[Frame]) -> bool:
        """Whether all of them could be sent."""
        ...

    def receive(self, timeout: float) -> Frame | None: ...

    def flush(self) -> None:
        """Forgets what came up to now."""
        ...

    def close(self) -> None: ...


class Clock(Protocol):
    """Deadlines a period apart: `RealTimeClock`, or that of an emulated bench."""

    @property
    def now(self) -> float: ...

    @property
    def left(self) -> float: ...

    def wait(self) -> Wake: ...


class Hooks(NamedTuple):
    """Whoever else has a part in a tick: a display, and the row of the fault that was seen."""

    show: Callable[[BicycleState], object] = lambda bicycle: None
    fault: Callable[[], int] = lambda: 0


class BenchRig:
    """A bar and a drive on one port; see `Rig`.

    Frames are taken while it waits for the deadline, in the loop's own thread, so that a tick finds
    what came. What feeds the drive's watchdog leaves only from a tick: the torque in `command`, the
    rest at the beginning of `wait`, and neither if the tick was later than `late` [s].
    """

    def __init__(
        self,
        info: RigInfo,
        port: Port,
        bar: Bar,
        drive: Drive,
        *,
        clock: Clock,
        late: float,
        others: Iterable[Traffic] = (),
    ) -> None:
        """`others` take frames besides, each of its ids."""
        self.info = info
        self._port, self._bar, self._drive, self._clock = port, bar, drive, clock
        self._takers: dict[int, tuple[Callable[[Frame, float], None], ...]] = {}
        for part in (bar, drive, *others):
            for identifier in part.ids:
                self._takers[identifier] = (*self._takers.get(identifier, ()), part.receive)
        self._host_ids = drive.host_ids
        self.hooks = Hooks()
        self.disabled: bool | None = None
        """Once closed: whether the drive said that it is disabled; None: it said nothing."""
        self._enable = False
        self._late_limit, self._on_time = late, True
        self._sent = self._late = 0.0
        self._origin = 0.0
        self._skipped = self._skipped_before = self._left_out = 0
        self._second_master = False
        self._closed = False
        self._seen: tuple[float, BarView, DriveView] | None = None

    @property
    def trouble(self) -> str:
        """Of the bus; empty where there is none."""
        return self._port.trouble

    def begin(self) -> None:
        """The next deadline is time zero of what follows, and nothing was skipped yet."""
        self._origin = self._clock.now + self._clock.left
        self.wait()
        self._skipped_before, self._left_out = self._skipped, 0
        self._late, self._on_time = 0.0, True

    def flush(self) -> None:
        """Forgets what came up to now: old frames, read all at once, would look like a fault."""
        self._port.flush()

    def read(self) -> Sample:
        """The newest sample, at the time that it is read, both on the host's clock."""
        for _ in range(_MOST_FRAMES):
            if not self._take(0.0):
                break
        now = self._clock.now
        bar, drive = self._bar.view(now), self._drive.view(now)
        time = round((now - self._origin) * _RESOLUTION) / _RESOLUTION
        self._seen = time, bar, drive
        return Sample(time, bar.steer, bar.steer_rate)

    def observation(self) -> Observation:
        """What the guard looks at; of this tick, once it was read."""
        assert self._seen is not None, "a bench is read before it is judged"
        time, bar, drive = self._seen
        # By position: with names it takes three times as long.
        return Observation(
            time, bar.steer, bar.steer_rate, bar.fresh, bar.sample_time, bar.age,
            bar.bad_frames, bar.frozen_frames, bar.pot_ok, bar.gyro_ok, bar.vref_ok,
            bar.estop_closed, drive.silent, drive.heartbeat_age,
            drive.trouble if self._enable else "", drive.error, drive.torque, self._sent,
            self._late, self._port.trouble, self._second_master, self._left_out,
        )  # fmt: skip

    @property
    def drive_view(self) -> DriveView:
        """Of this tick."""
        assert self._seen is not None, "a bench is read before it is judged"
        return self._seen[2]

    def enable(self, wanted: bool) -> None:
        """From the next command on."""
        self._enable = wanted

    def command(self, torque: float) -> float:
        """To the drive; a torque that is not finite, or for a drive not enabled, is zero."""
        if not math.isfinite(torque):
            torque = 0.0
        frames, self._sent = self._drive.command(torque, enable=self._enable, on_time=self._on_time)
        self._port.send(frames)
        return self._sent

    def show(self, bicycle: BicycleState) -> None:
        """To the display."""
        self.hooks.show(bicycle)

    def telemetry(self) -> tuple[float, ...]:
        """BENCH_CHANNELS."""
        assert self._seen is not None
        _, bar, drive = self._seen
        return (
            bar.age, bar.sample_time, float(bar.lost), drive.age, float(drive.enabled),
            drive.torque, float(self.hooks.fault()), self._late,
            float(self._skipped - self._skipped_before),
        )  # fmt: skip

    def wait(self) -> None:
        """To the deadline, taking what comes."""
        self._port.send(self._drive.upkeep(self._clock.now, on_time=self._on_time))
        # The rest is slept, which is more exact.
        margin = self._port.wakes_late
        while (left := self._clock.left - margin) > 0:
            if not self._take(left):
                break
        late, self._left_out = self._clock.wait()
        self._skipped += self._left_out
        # It was to meet the first of those, whichever it serves now.
        self._late = late + self._left_out * self.info.period
        self._on_time = self._late <= self._late_limit

    def close(self) -> None:
        """Zero torque and a disabled drive, said until it is; then the bus ends."""
        if self._closed:
            return
        self._closed = True
        self._enable = False
        try:
            self._bid_farewell()
        finally:
            self._port.close()

    def _bid_farewell(self) -> None:
        """Twice at least, as one may get lost; the drive's answer is awaited, not for ever.

        A bus in trouble may carry it all the same: only where it cannot be sent it ends early.
        """
        end = self._clock.now + _PATIENCE + self._drive.heartbeat_period
        said = 0
        while (began := self._clock.now) < end and (said < _LEAST or self.disabled is not True):
            sent = self._port.send(self._drive.farewell())
            said += 1
            self._hear_until(began + _BETWEEN)
            if not sent and said >= _LEAST:
                break

    def _hear_until(self, end: float) -> None:
        """What the drive says of itself; where nothing can be received the time passes too."""
        while (left := end - self._clock.now) > 0:
            if self._take(left):
                seen = self._drive.view(self._clock.now)
                if max(seen.age, seen.heartbeat_age) < math.inf:
                    self.disabled = not seen.enabled
            elif self._clock.now < end:
                self._clock.wait()

    def _take(self, timeout: float) -> bool:
        frame = self._port.receive(timeout)
        if frame is None:
            return False
        takers = self._takers.get(frame.id)
        if takers is not None:
            now = self._clock.now
            for take in takers:
                take(frame, now)
        if frame.id in self._host_ids:
            self._second_master = True
        return True
