"""Sets an ODrive up over CANSimple, and proves its watchdog. It is idle before and after."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from bikesim.bench.frame import Frame
from bikesim.bench.link import Link, until
from bikesim.bench.odrive import (
    AxisError,
    AxisHeartbeat,
    AxisState,
    Command,
    clear_errors,
    errors_told,
    message_id,
    set_axis_state,
    set_input_torque,
    set_limits,
    set_torque_mode,
    unpack_errors,
    unpack_heartbeat,
    unpack_torques,
)
from bikesim.bench.odrive_settings import ODriveSettings
from bikesim.bench.rest_torque import check_rest_torque
from bikesim.errors import InputError

_PATIENCE = 1.0  # s
_PERIOD = 0.005  # s, between two torque commands
_LISTEN = 0.3  # s, to count cyclic messages
_HOLD = 0.05  # s, beyond a heartbeat's period, enabled before the silence
_LATE = 0.02  # s, beyond the time-out, that it may take


class ODriveReport(NamedTuple):
    """What was found: how long after the last torque command it was disarmed [s], at most; inf if
    that was not tried.

    The ODrive tells with its heartbeat, so up to one of its periods later than it was; but it is
    disarmed before the heartbeat that comes 20 ms after the time-out.

    `fault`: with which errors it was found, that are cleared now, in words; empty if with none.
    """

    disarmed_after: float
    fault: str = ""


def set_up(link: Link, drive: ODriveSettings, *, prove: bool = True) -> ODriveReport:
    """Clears errors, sets mode and limits, counts the cyclic messages, proves the watchdog.

    Raises InputError, so for an axis that measures a torque before it is told any (fault 25); the
    torque is zero all the time and the axis idle at the end, without `prove` all the time.
    """
    return _SetUp(link, drive).run(prove)


class _SetUp:
    def __init__(self, link: Link, drive: ODriveSettings) -> None:
        self._link, self._drive, self._node = link, drive, drive.node
        self._heard = 0.0  # s, its newest heartbeat
        self._at_rest = False  # from here on it must not measure a torque

    def run(self, prove: bool) -> ODriveReport:
        self._send(set_input_torque(self._node, 0.0))
        self._send(set_axis_state(self._node, AxisState.IDLE))
        self._expect(_is_idle, "does not become idle")
        # Nothing is to be enabled that has not been seen at rest; calibrating enables nothing.
        self._at_rest = prove
        fault = self._check_cyclic()
        self._send(set_torque_mode(self._node))
        limits = self._drive.velocity_limit, self._drive.current_limit
        self._send(set_limits(self._node, *limits))
        try:
            return ODriveReport(self._prove_watchdog() if prove else math.inf, fault)
        finally:
            self._send(set_axis_state(self._node, AxisState.IDLE))
            self._send(clear_errors(self._node))

    def _check_cyclic(self) -> str:
        """Each message comes as often as the profile says; listened to, not asked for.

        Gives the errors that they tell, see `ODriveReport`.
        """
        wanted = {
            Command.HEARTBEAT: ("heartbeat", self._drive.heartbeat_period),
            Command.GET_ENCODER_ESTIMATES: ("encoder", self._drive.estimates_period),
            Command.GET_TORQUES: ("torques", self._drive.torques_period),
        }
        slowest = max(period for _, period in wanted.values())
        duration = max(_LISTEN, 3 * slowest)
        frames = tuple(self._frames(self._link.now() + duration))
        came = [frame.id for frame in frames]
        for command, (name, period) in wanted.items():
            count = came.count(message_id(self._node, command))
            if count + 1 < 0.5 * duration / period:
                raise self._error(
                    f"sent {count} {name} messages in {duration:g} s, the profile expects one "
                    f"every {1000 * period:g} ms: set {name}_msg_rate_ms in the ODrive"
                )
        return _found_with(self._errors(frames))

    def _errors(self, frames: Iterable[Frame]) -> int:
        """What is wrong, and what it was last disarmed by: the two bit by bit."""
        errors = 0
        for frame in frames:
            if frame.id == message_id(self._node, Command.HEARTBEAT):
                said = unpack_heartbeat(frame.data)
                errors |= said.errors if said else 0
            elif frame.id == message_id(self._node, Command.GET_ERROR):
                told = unpack_errors(frame.data)
                errors |= told.active | told.disarm_reason if told else 0
        return errors

    def _prove_watchdog(self) -> float:
        """Enabled at zero torque, then silent: it must disarm, and say that it was for that."""
        # Fed before and after: a watchdog that has run out is an error again at once.
        self._send(set_input_torque(self._node, 0.0))
        self._send(clear_errors(self._node))
        self._send(set_axis_state(self._node, AxisState.CLOSED_LOOP_CONTROL))
        self._expect(_is_enabled, "does not go into closed-loop control", feed=True)
        self._hold()
        last = self._link.now()
        # To the heartbeat that `_hold` aimed at, should it come late, but not to the one after it.
        to_be_told = self._allowed + 0.5 * self._drive.heartbeat_period
        disarmed = self._heartbeat(lambda said: not _is_enabled(said), last + to_be_told)
        if disarmed is None:
            raise self._error(
                f"is still enabled {self._allowed:.3f} s after the last torque command: set "
                f"enable_watchdog and watchdog_timeout = {self._drive.watchdog_timeout:g} in it"
            )
        if not disarmed.errors & AxisError.WATCHDOG_TIMER_EXPIRED:
            raise self._error(f"disarmed, but not by its watchdog: {errors_told(disarmed.errors)}")
        return self._link.now() - last

    @property
    def _allowed(self) -> float:
        """In which its watchdog must have run out [s]."""
        return self._drive.watchdog_timeout + _LATE

    def _hold(self) -> None:
        """Fed, it must stay enabled.

        Ends so long before a heartbeat that this one must say that it is disarmed: heartbeats far
        apart would else hide how late it was.
        """
        period = self._drive.heartbeat_period
        self._feed_until(self._link.now() + period + _HOLD)
        beats = math.ceil((self._link.now() + self._allowed - self._heard) / period)
        self._feed_until(self._heard + beats * period - self._allowed)
        self._send(set_input_torque(self._node, 0.0))

    def _feed_until(self, end: float) -> None:
        while (now := self._link.now()) < end:
            self._send(set_input_torque(self._node, 0.0))
            fed = self._heartbeat(lambda said: not _is_enabled(said), min(now + _PERIOD, end))
            if fed is not None:
                raise self._error(f"disarmed while it was fed: {errors_told(fed.errors)}")

    def _expect(
        self, is_so: Callable[[AxisHeartbeat], bool], otherwise: str, feed: bool = False
    ) -> None:
        deadline = self._link.now() + _PATIENCE
        last = None
        while self._link.now() < deadline:
            if feed:
                self._send(set_input_torque(self._node, 0.0))
            said = self._heartbeat(lambda _: True, self._link.now() + _PERIOD)
            if said is not None and is_so(said):
                return
            last = said or last
        if last is None:
            raise self._error("sends no heartbeat")
        raise self._error(f"{otherwise}: state {last.state}, {errors_told(last.errors)}")

    def _heartbeat(
        self, wanted: Callable[[AxisHeartbeat], bool], deadline: float
    ) -> AxisHeartbeat | None:
        """The first that is wanted."""
        for frame in self._frames(deadline):
            if frame.id != message_id(self._node, Command.HEARTBEAT):
                continue
            said = unpack_heartbeat(frame.data)
            if said is None:
                continue
            self._heard = self._link.now()
            if wanted(said):
                return said
        return None

    def _frames(self, deadline: float) -> Iterator[Frame]:
        for frame in until(self._link, deadline):
            if self._at_rest and frame.id == message_id(self._node, Command.GET_TORQUES):
                torques = unpack_torques(frame.data)
                if torques is not None:
                    check_rest_torque(self._drive.torque(torques.estimate))
            yield frame

    def _send(self, frame: Frame) -> None:
        self._link.send(frame)

    def _error(self, what: str) -> InputError:
        return InputError(f"ODrive {self._node}: {what}")


def _found_with(errors: int) -> str:
    """A watchdog that has run out alone is how an ODrive waits for its host."""
    if errors == AxisError.WATCHDOG_TIMER_EXPIRED:
        return "its watchdog had run out, cleared now"
    return f"it had failed: {errors_told(errors)}; cleared now" if errors else ""


def _is_idle(said: AxisHeartbeat) -> bool:
    return said.state == AxisState.IDLE


def _is_enabled(said: AxisHeartbeat) -> bool:
    return said.state == AxisState.CLOSED_LOOP_CONTROL
