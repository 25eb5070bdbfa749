import math
from dataclasses import replace

import pytest

from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.odrive import EmulatedODrive, ODriveConfiguration
from bikesim.bench.frame import Frame
from bikesim.bench.link import BusLink
from bikesim.bench.odrive import AxisError, AxisState, set_axis_state, set_input_torque
from bikesim.bench.odrive_drive import ODrive
from bikesim.bench.odrive_settings import ODriveSettings
from bikesim.bench.odrive_setup import set_up
from bikesim.errors import InputError

from .conftest import Wire


def emulated(drive: ODriveSettings, **changes) -> EmulatedODrive:
    return EmulatedODrive(3, replace(ODriveConfiguration.of_profile(drive), **changes))


@pytest.mark.parametrize("feeds", [True, False])
def test_what_it_leaves(odrive: ODriveSettings, feeds: bool):
    device = emulated(odrive, any_frame_feeds=feeds)
    report = set_up(SimulatedLink([device]), odrive)
    assert 0.030 < report.disarmed_after <= 0.030 + 0.010 + 0.003
    assert report.fault == "its watchdog had run out, cleared now"
    assert (device.state, device.errors, device.torque) == (AxisState.IDLE, 0, 0.0)
    now = 1000.0
    device.receive(set_input_torque(3, 9.0), now)
    device.receive(set_axis_state(3, AxisState.CLOSED_LOOP_CONTROL), now)
    assert device.torque * odrive.gear == pytest.approx(odrive.torque_limit)


class Listening(EmulatedODrive):
    """Keeps the largest torque that it ever gave, and what was asked of it."""

    largest = 0.0
    polled = 0

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        self.polled += frame.remote
        sent = super().receive(frame, time)
        self.largest = max(self.largest, abs(self.torque))
        return sent


def test_no_torque_is_ever_given_and_nothing_is_polled(odrive: ODriveSettings):
    device = Listening(3, ODriveConfiguration.of_profile(odrive))
    device._input_torque = 0.7
    set_up(SimulatedLink([device]), odrive)
    assert (device.largest, device.polled) == (0.0, 0)


def test_without_the_proof_it_is_never_enabled(odrive: ODriveSettings):
    class Watched(Listening):
        def receive(self, frame: Frame, time: float) -> list[Frame]:
            sent = super().receive(frame, time)
            assert self.state is AxisState.IDLE
            return sent

    device = Watched(3, ODriveConfiguration.of_profile(odrive))
    assert set_up(SimulatedLink([device]), odrive, prove=False).disarmed_after == math.inf
    assert (device.state, device.errors, device.largest) == (AxisState.IDLE, 0, 0.0)


def refused(device: EmulatedODrive, drive: ODriveSettings) -> str:
    with pytest.raises(InputError) as error:
        set_up(SimulatedLink([device]), drive)
    assert "\n" not in str(error.value)
    assert device.torque == 0.0
    assert device.state is AxisState.IDLE
    return str(error.value)


@pytest.mark.parametrize("timeout", [None, 0.5], ids=str)
def test_without_its_watchdog_it_is_refused(odrive: ODriveSettings, timeout: float | None):
    told = refused(emulated(odrive, watchdog_timeout=timeout), odrive)
    assert "still enabled" in told
    assert "watchdog_timeout = 0.03" in told


@pytest.mark.parametrize("heartbeat_period", [0.01, 0.02, 0.1])
@pytest.mark.parametrize("timeout", [0.06, 0.1, 0.14])
@pytest.mark.parametrize("began", range(0, 100, 13))
def test_a_slow_watchdog_is_not_hidden_by_slow_heartbeats(
    odrive: ODriveSettings, heartbeat_period: float, timeout: float, began: int
):
    """Whatever the phase of the heartbeats; of 30 ms, 20 ms more are allowed."""
    drive = odrive.model_copy(update={"heartbeat_period": heartbeat_period})
    late = SimulatedLink([emulated(drive, watchdog_timeout=timeout)])
    late.receive(0.001 * began)
    with pytest.raises(InputError, match=r"still enabled 0\.050 s after"):
        set_up(late, drive)
    good = SimulatedLink([emulated(drive)])
    good.receive(0.001 * began)
    assert set_up(good, drive).disarmed_after <= 0.05 + 0.5 * heartbeat_period


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"estimates_period": 0.0}, "sent 0 encoder messages"),
        ({"estimates_period": 0.01}, "set encoder_msg_rate_ms"),
        ({"heartbeat_period": 0.1}, "set heartbeat_msg_rate_ms"),
        ({"torques_period": 0.0}, "set torques_msg_rate_ms"),
        ({"heartbeat_period": 0.0}, "sends no heartbeat"),
    ],
    ids=str,
)
def test_messages_that_do_not_come_are_named(odrive: ODriveSettings, changes: dict, told: str):
    assert told in refused(emulated(odrive, **changes), odrive)


def test_a_torque_at_rest_is_refused_before_it_is_enabled(odrive: ODriveSettings):
    class Watched(EmulatedODrive):
        def receive(self, frame: Frame, time: float) -> list[Frame]:
            sent = super().receive(frame, time)
            assert self.state is AxisState.IDLE
            return sent

    device = Watched(3, ODriveConfiguration.of_profile(odrive))
    device.offset = 0.11 / odrive.gear
    told = refused(device, odrive)
    assert told == ("fault 25: the drive measures +0.11 N m before it is told any; allowed 0.1 N m")


def test_the_torque_of_noise_is_allowed(odrive: ODriveSettings):
    device = emulated(odrive)
    device.offset = 0.09 / odrive.gear
    assert set_up(SimulatedLink([device]), odrive).disarmed_after < math.inf


def test_a_torque_of_its_own_once_it_is_enabled_ends_in_idle_at_once(odrive: ODriveSettings):
    class Pulling(EmulatedODrive):
        pulled = 0

        def advance(self, time: float) -> list[Frame]:
            enabled = self.state is AxisState.CLOSED_LOOP_CONTROL
            self.offset = -0.5 if enabled else 0.0
            self.pulled += enabled
            return super().advance(time)

    device = Pulling(3, ODriveConfiguration.of_profile(odrive))
    assert refused(device, odrive).startswith("fault 25: the drive measures -2.00 N m")
    assert device.pulled <= 2  # ms: its torque comes every two


@pytest.mark.parametrize("still", [True, False])
def test_what_it_had_failed_with_is_told(odrive: ODriveSettings, still: bool):
    """Over current while it rode: told at the next start, not at the one after.

    Also where it has no error any more, but knows what it was disarmed by.
    """
    device = emulated(odrive)
    link = SimulatedLink([device])
    set_up(link, odrive)
    device.receive(set_input_torque(3, 0.0), link.now())
    device.receive(set_axis_state(3, AxisState.CLOSED_LOOP_CONTROL), link.now())
    device.break_down()
    device.errors *= still
    lines = ODrive(odrive).set_up_over(link)
    assert lines[0].startswith("ODrive 3: it had failed: dc bus over current")
    assert set_up(link, odrive).fault == "its watchdog had run out, cleared now"


class Broken(EmulatedODrive):
    """Has an error that comes back as soon as it is cleared."""

    def advance(self, time: float) -> list[Frame]:
        self.fail(AxisError.DRV_FAULT)
        return super().advance(time)


def test_an_axis_that_cannot_be_enabled(odrive: ODriveSettings):
    device = Broken(3, ODriveConfiguration.of_profile(odrive))
    assert "does not go into closed-loop control: state 1, drv fault" in refused(device, odrive)


def test_nobody_answers(odrive: ODriveSettings):
    with pytest.raises(InputError, match="ODrive 3: sends no heartbeat"):
        set_up(SimulatedLink([]), odrive)


def test_over_a_bus(wire: Wire, odrive: ODriveSettings):
    """In real time, with figures for a machine that has other things to do."""
    drive = odrive.model_copy(
        update={"watchdog_timeout": 0.2, "estimates_period": 0.01, "torques_period": 0.02}
    )
    device = emulated(drive)
    with wire.with_devices(device) as bus:
        assert set_up(BusLink(bus), drive).disarmed_after > 0.19
        assert device.torque == 0.0
