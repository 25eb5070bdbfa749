"""An ODrive in torque mode, as the loop has it."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from bikesim.bench.drive import Cyclic, DriveView
from bikesim.bench.finding import Finding
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import (
    AxisState,
    Command,
    clear_errors,
    errors_told,
    ids_from_odrive,
    ids_to_odrive,
    message_id,
    set_axis_state,
    set_input_torque,
    unpack_errors,
    unpack_estimates,
    unpack_heartbeat,
    unpack_torques,
)
from bikesim.bench.odrive_findings import Said, odrive_findings
from bikesim.bench.odrive_settings import ODriveSettings

if TYPE_CHECKING:
    import can

    from bikesim.bench.link import Link

_ERRORS_PERIOD = 0.1  # s, of Get_Error as it leaves the factory


class ODrive:
    """See `Drive`. Its watchdog is fed by the torque frames, and nothing else is sent to it.

    Its errors are cleared only on the way to being enabled for the first time: since it was set up
    its watchdog has run out.
    """

    def __init__(self, settings: ODriveSettings) -> None:
        self._settings = settings
        node = settings.node
        self._heartbeat_id = message_id(node, Command.HEARTBEAT)
        self._error_id = message_id(node, Command.GET_ERROR)
        self._estimates_id = message_id(node, Command.GET_ENCODER_ESTIMATES)
        self._torques_id = message_id(node, Command.GET_TORQUES)
        self._state, self._asked = int(AxisState.IDLE), False
        self._sent = 0.0
        self._torque = self._steer = self._steer_rate = 0.0
        self._estimated = self._measured = self._heard = -math.inf
        self._error = ""
        self._armed = False
        self._errors = 0
        self._disarm_reason: int | None = None

    @property
    def name(self) -> str:
        return f"ODrive {self._settings.node}"

    @property
    def heartbeat_period(self) -> float:
        return self._settings.heartbeat_period

    @property
    def watchdog_timeout(self) -> float:
        return self._settings.watchdog_timeout

    @property
    def ids(self) -> frozenset[int]:
        return frozenset(ids_from_odrive(self._settings.node))

    @property
    def host_ids(self) -> frozenset[int]:
        return frozenset(ids_to_odrive(self._settings.node))

    def set_up(self, bus: "can.BusABC", *, prove: bool = True) -> tuple[str, ...]:
        from bikesim.bench.link import BusLink

        return self.set_up_over(BusLink(bus), prove=prove)

    def set_up_over(self, link: "Link", *, prove: bool = True) -> tuple[str, ...]:
        """As `set_up`, in the time of a link."""
        from bikesim.bench.odrive_setup import set_up

        report = set_up(link, self._settings, prove=prove)
        fault = (f"{self.name}: {report.fault}",) if report.fault else ()
        if not prove:
            return (*fault, f"{self.name}: its watchdog was not tried")
        within = f"within {1e3 * report.disarmed_after:.0f} ms of the last torque command"
        return (*fault, f"{self.name}: its watchdog disarmed it {within}")

    def receive(self, frame: Frame, time: float) -> None:
        identifier, data = frame.id, frame.data
        if identifier == self._estimates_id:
            estimates = unpack_estimates(data)
            if estimates is not None and self._are_finite("encoder", estimates):
                self._estimated = time
                self._steer = self._settings.steer(estimates.position)
                self._steer_rate = self._settings.steer_rate(estimates.velocity)
        elif identifier == self._torques_id:
            torques = unpack_torques(data)
            if torques is not None and self._are_finite("torque", torques):
                self._measured = time
                self._torque = self._settings.torque(torques.estimate)
        elif identifier == self._heartbeat_id:
            said = unpack_heartbeat(data)
            if said is not None:
                self._heard, self._state = time, said.state
                if said.state == AxisState.CLOSED_LOOP_CONTROL and self._asked:
                    self._armed = True
                self._take_errors(said.errors)
        elif identifier == self._error_id:
            errors = unpack_errors(data)
            if errors is not None:
                self._take_errors(errors.active)
                self._disarm_reason = errors.disarm_reason

    def command(
        self, torque: float, *, enable: bool, on_time: bool = True
    ) -> tuple[list[Frame], float]:
        node = self._settings.node
        if not enable:
            self._asked, self._armed, self._sent, self._error = False, False, 0.0, ""
            return [set_input_torque(node, 0.0), set_axis_state(node, AxisState.IDLE)], 0.0
        if self._state != AxisState.CLOSED_LOOP_CONTROL:
            frames = [set_input_torque(node, 0.0)]
            if not self._asked:
                frames.append(clear_errors(node))
                frames.append(set_axis_state(node, AxisState.CLOSED_LOOP_CONTROL))
                self._asked = True
            self._sent = 0.0
            return frames, 0.0
        at_motor = self._settings.to_motor(torque)
        if not on_time and at_motor:
            return [], self._sent
        self._sent = self._settings.torque(at_motor)
        return [set_input_torque(node, at_motor)], self._sent

    def upkeep(self, time: float, *, on_time: bool = True) -> list[Frame]:
        del time, on_time
        return []

    def traffic(self, period: float) -> tuple[tuple[int, float], ...]:
        s = self._settings
        theirs = (s.heartbeat_period, _ERRORS_PERIOD, s.estimates_period, s.torques_period)
        return (8, 1 / period), *((8, 1 / one) for one in theirs)

    def farewell(self) -> list[Frame]:
        node = self._settings.node
        return [set_input_torque(node, 0.0), set_axis_state(node, AxisState.IDLE)]

    def cyclic(self, period: float) -> tuple[Cyclic, ...]:
        del period
        s = self._settings
        return (
            Cyclic(self._heartbeat_id, "heartbeat", 1 / s.heartbeat_period),
            Cyclic(self._estimates_id, "encoder", 1 / s.estimates_period),
            Cyclic(self._torques_id, "torques", 1 / s.torques_period),
        )

    def findings(self) -> Iterator[Finding]:
        heard = self._heard > -math.inf
        said = Said(
            self._state if heard else None, self._errors if heard else None, self._disarm_reason
        )
        return odrive_findings(self._settings, said)

    def view(self, time: float) -> DriveView:
        enabled = self._state == AxisState.CLOSED_LOOP_CONTROL
        return DriveView(
            time - self._estimated,
            max(time - self._due(), 0.0),
            time - self._heard,
            enabled,
            "" if enabled else self._trouble(),
            self._error,
            self._torque,
            self._steer,
            self._steer_rate,
        )

    def _due(self) -> float:
        """When the one of its two messages that is missing longest should have come [s]."""
        s = self._settings
        return min(self._estimated + s.estimates_period, self._measured + s.torques_period)

    def _are_finite(self, what: str, figures: tuple[float, float]) -> bool:
        """Else it is an error of the drive; nothing is to be reckoned with such a figure."""
        if math.isfinite(figures[0]) and math.isfinite(figures[1]):
            return True
        said = ", ".join(f"{one:g}" for one in figures)
        self._error = f"{self.name} sends {what} estimates that are no finite numbers: {said}"
        return False

    def _take_errors(self, errors: int) -> None:
        self._errors = errors
        if errors and self._armed:
            self._error = f"{self.name} reports {errors_told(errors)}"

    def _trouble(self) -> str:
        told = f": {errors_told(self._errors)}" if self._errors else ""
        return (
            f"{self.name} is in state {self._state}, not {int(AxisState.CLOSED_LOOP_CONTROL)}{told}"
        )
