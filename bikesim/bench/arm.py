"""From a bus to an enabled drive at zero torque, or to one line that says why not."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from bikesim.bench.bus_errors import received
from bikesim.bench.drive import Drive
from bikesim.bench.faults import Fault, Observation, Reaction, Thresholds
from bikesim.bench.frame import from_message
from bikesim.bench.monitors import monitors
from bikesim.bench.rest_torque import check_rest_torque
from bikesim.bench.rig import BenchRig
from bikesim.bench.senses import Bar
from bikesim.bench.traffic import Traffic
from bikesim.errors import InputError

if TYPE_CHECKING:
    import can

LISTEN = 0.25
"""So long the bus is listened to before anything is sent [s]."""

_PATIENCE, _REST = 2.0, 0.2  # s

_STOP_OPEN = "fault 21: the emergency stop is open: close it first"


def listen(
    bus: "can.BusABC",
    drive: Drive,
    bar: Bar,
    others: Iterable[Traffic] = (),
    *,
    enabling: bool = True,
) -> None:
    """Hears who is there, sending nothing. Raises InputError: nobody, another host, no bus.

    `enabling`: the drive is to be; then an emergency stop seen open, which takes its power and
    thus its answers, is refused too.
    """
    import time

    heard: set[int] = set()
    errors = False
    end = time.monotonic() + LISTEN
    while (left := end - time.monotonic()) > 0:
        message = received(bus, left)
        if message is None:
            break
        errors |= message.is_error_frame
        frame = from_message(message)
        if frame is not None:
            heard.add(frame.id)
            if frame.id in bar.ids:
                bar.receive(frame, time.monotonic())
    if masters := sorted(heard & drive.host_ids):
        raise InputError(
            f"fault 24: somebody else sends {_told(masters)}, which is this host's to send: "
            "two hosts on one bus"
        )
    expected = bar.ids.union(*(one.ids for one in others))
    # Without sensors of its own a bench may be silent: a drive need not speak before it is asked.
    if (expected or errors) and not heard & (expected | drive.ids):
        why = "error frames only: is bus.bitrate right?" if errors else "power, wiring, bus.bitrate"
        raise InputError(f"nobody answers on the bus within {LISTEN:g} s: {why}")
    if silent := sorted(expected - heard):
        raise InputError(f"nobody sends {_told(silent)} within {LISTEN:g} s: is the node powered?")
    seen = bar.view(time.monotonic())
    if enabling and seen.fresh and not seen.estop_closed:
        raise InputError(_STOP_OPEN)


def _told(ids: Iterable[int]) -> str:
    return ", ".join(f"{one:#05x}" for one in ids)


def arm(rig: BenchRig, thresholds: Thresholds, heartbeat_period: float) -> None:
    """Ticks at zero torque until the drive is enabled and everything has been well for a while.

    Raises InputError; the drive then still has to be disabled, by closing the rig.
    """
    _Arming(rig, thresholds, heartbeat_period).run()


class _Arming:
    def __init__(self, rig: BenchRig, thresholds: Thresholds, heartbeat_period: float) -> None:
        self._rig, self._thresholds = rig, thresholds
        self._heartbeat_period = heartbeat_period

    def run(self) -> None:
        self._rig.enable(False)
        self._rig.flush()
        self._until(self._senses, "the sensors do not become ready")
        self._rig.enable(True)
        self._until(self._enabled, "the drive does not become enabled")
        self._rest()

    def _tick(self) -> Observation:
        self._rig.read()
        o = self._rig.observation()
        if o.second_master:
            raise InputError(
                "fault 24: a command of this host's own was received: another host, or an "
                "interface that gives back what one sends"
            )
        if o.bus_trouble:
            raise InputError(f"fault 20: {o.bus_trouble}")
        if not o.estop_closed:
            raise InputError(_STOP_OPEN)
        check_rest_torque(o.torque_measured, self._thresholds.rest_torque)
        self._rig.command(0.0)
        self._rig.wait()
        return o

    def _until(self, ready, otherwise: str) -> None:
        began: float | None = None
        while not ready(o := self._tick()):
            began = o.time if began is None else began
            if o.time - began > _PATIENCE:
                raise InputError(f"{otherwise} within {_PATIENCE:g} s: {self._why(o)}")

    def _senses(self, o: Observation) -> bool:
        return o.fresh and o.age <= self._thresholds.hold_age

    def _enabled(self, o: Observation) -> bool:
        heard = self._thresholds.drive_heartbeats * self._heartbeat_period
        return self._rig.drive_view.enabled and o.drive_heartbeat_age <= heard

    def _why(self, o: Observation) -> str:
        if o.drive_trouble or o.drive_error:
            return o.drive_error or o.drive_trouble
        if self._rig.drive_view.enabled:
            return f"its newest heartbeat is {1e3 * o.drive_heartbeat_age:.0f} ms old"
        return f"the newest good sample is {1e3 * o.age:.0f} ms old"

    def _rest(self) -> None:
        """As in the ride, at zero torque: what would end it must not be there."""
        watch = monitors(self._thresholds, self._heartbeat_period, self._rig.info.period)
        began: float | None = None
        while True:
            o = self._tick()
            began = o.time if began is None else began
            for look in watch:
                fault: Fault | None = look(o)
                if fault is not None and fault.reaction > Reaction.HOLD:
                    raise InputError(f"at rest, before any torque: {fault}")
            if o.time - began >= _REST:
                return
