"""The messages, byte by byte, and the emulated ODrive."""

import math
import struct

import pytest

from bikesim.bench.emulated.odrive import EmulatedODrive, ODriveConfiguration
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import (
    AxisError,
    AxisState,
    Command,
    clear_errors,
    errors_told,
    estop,
    ids_from_odrive,
    ids_to_odrive,
    message_id,
    set_axis_state,
    set_input_torque,
    set_limits,
    set_torque_mode,
    unpack_errors,
    unpack_estimates,
    unpack_heartbeat,
    unpack_torques,
)
from bikesim.bench.odrive_settings import ODriveSettings
from bikesim.errors import InputError


def test_identifier_is_node_and_command():
    assert message_id(3, Command.HEARTBEAT) == 0x061
    assert message_id(3, Command.GET_TORQUES) == 0x07C


def test_the_frames_of_the_table():
    assert estop(3) == Frame(0x062)
    assert clear_errors(3) == Frame(0x078, b"\0")
    assert set_axis_state(3, AxisState.CLOSED_LOOP_CONTROL) == Frame(0x067, b"\x08\0\0\0")
    assert set_torque_mode(3) == Frame(0x06B, bytes.fromhex("0100000001000000"))
    assert set_input_torque(3, -0.5) == Frame(0x06E, bytes.fromhex("000000bf00000000"))
    assert set_limits(3, 2.0, 10.0) == Frame(0x06F, bytes.fromhex("0000004000002041"))


def test_what_it_tells():
    assert unpack_heartbeat(bytes.fromhex("0000000301080100"))[1] == 1  # type: ignore
    assert unpack_heartbeat(bytes.fromhex("0000000208030000")) == (0x02000000, 8, 3)
    assert unpack_errors(bytes.fromhex("0000000100000002")) == (0x01000000, 0x02000000)
    assert unpack_estimates(bytes.fromhex("0000803f000000bf")) == (1.0, -0.5)
    assert unpack_torques(bytes.fromhex("0000003f0000803e")) == (0.5, 0.25)


@pytest.mark.parametrize(
    "unpack", [unpack_heartbeat, unpack_errors, unpack_estimates, unpack_torques]
)
@pytest.mark.parametrize("data", [b"", bytes(7), bytes(4)], ids=len)
def test_what_is_none_is_no_error(unpack, data: bytes):
    assert unpack(data) is None


def test_errors_have_names():
    assert errors_told(0x03000000) == "watchdog timer expired, estop requested"
    assert errors_told(0x80000001) == "initializing, 0x80000000"
    assert errors_told(0) == "no error"


def test_each_identifier_is_of_one_side():
    assert not set(ids_from_odrive(3)) & set(ids_to_odrive(3))
    assert len(ids_from_odrive(3)) + len(ids_to_odrive(3)) == len(Command)


@pytest.mark.parametrize("direction", [1, -1])
def test_between_axis_and_shaft(odrive: ODriveSettings, direction: int):
    drive = odrive.model_copy(update={"direction": direction})
    assert drive.to_motor(2.0) == direction * 0.5
    assert drive.to_motor(99.0) == direction * 0.75
    assert drive.torque(0.5) == direction * 2.0
    assert drive.steer(1.0) == pytest.approx(direction * math.pi / 2)
    assert drive.steer_rate(2.0) == pytest.approx(direction * math.pi)
    assert drive.to_motor(math.nan) == drive.to_motor(math.inf) == 0.0


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"node": 63}, "drive.node = 63: must be"),
        ({"torque_constant": 0.0}, "drive.torque_constant = 0.0: must be"),
        ({"torque_limit": 10.5}, "drive.torque_limit = 10.5: must be"),
        ({"watchdog_timeout": 1.0}, "drive.watchdog_timeout = 1.0: must be"),
    ],
    ids=str,
)
def test_a_profile_that_cannot_be_is_refused_in_one_line(given: dict, told: str):
    usual = {"node": 3, "torque_constant": 0.05, "torque_limit": 3.0}
    with pytest.raises(InputError) as error:
        ODriveSettings(**{**usual, **given})
    assert told in str(error.value)
    assert "\n" not in str(error.value)


class Riding:
    """An ODrive that is enabled and gives torque, millisecond by millisecond."""

    def __init__(self, drive: ODriveSettings, **changes) -> None:
        usual = ODriveConfiguration.of_profile(drive)
        configuration = ODriveConfiguration(
            **{f: changes.get(f, getattr(usual, f)) for f in usual.__slots__}
        )
        self.device, self.now = EmulatedODrive(3, configuration), 0.0
        self.sent: list[Frame] = []
        self.device.advance(0.0)
        limits = set_limits(3, drive.velocity_limit, drive.current_limit)
        state = set_axis_state(3, AxisState.CLOSED_LOOP_CONTROL)
        for frame in (set_torque_mode(3), limits, state, set_input_torque(3, 0.5)):
            self.device.receive(frame, 0.0)
        assert self.device.torque == 0.5

    def tick(self, *frames: Frame) -> None:
        for frame in frames:
            self.sent += self.device.receive(frame, self.now)
        self.now += 0.001
        self.sent += self.device.advance(self.now)

    def came(self, command: Command) -> list[bytes]:
        return [frame.data for frame in self.sent if frame.id == message_id(3, command)]


def test_a_host_that_is_killed_leaves_no_torque_after_its_timeout(odrive: ODriveSettings):
    riding = Riding(odrive)
    while riding.device.torque:
        riding.tick()
    assert riding.now == pytest.approx(0.030, abs=0.0015)
    for _ in range(10):
        riding.tick()
    told = unpack_heartbeat(riding.came(Command.HEARTBEAT)[-1])
    assert told == (AxisError.WATCHDOG_TIMER_EXPIRED, AxisState.IDLE, 3)
    assert riding.device.disarm_reason == AxisError.WATCHDOG_TIMER_EXPIRED


def test_without_a_watchdog_the_last_torque_stays(odrive: ODriveSettings):
    riding = Riding(odrive, watchdog_timeout=None)
    for _ in range(1000):
        riding.tick()
    assert riding.device.torque == 0.5


@pytest.mark.parametrize(("feeds", "torque"), [(True, 0.5), (False, 0.0)])
def test_where_any_frame_feeds_polling_keeps_an_old_torque(
    odrive: ODriveSettings, feeds: bool, torque: float
):
    riding = Riding(odrive, any_frame_feeds=feeds)
    for _ in range(100):
        riding.tick(Frame(message_id(3, Command.GET_ENCODER_ESTIMATES), remote=True))
    assert riding.device.torque == torque


def test_it_keeps_to_its_current_limit(odrive: ODriveSettings):
    riding = Riding(odrive)
    riding.tick(set_input_torque(3, 50.0))
    assert riding.device.torque * odrive.gear == pytest.approx(odrive.torque_limit)


def test_too_fast_disarms_it(odrive: ODriveSettings):
    riding = Riding(odrive)
    riding.device.rate = 1.3 * odrive.speed_limit * odrive.gear
    riding.tick(set_input_torque(3, 0.5))
    assert riding.device.torque == 0.0
    assert riding.device.errors == AxisError.VELOCITY_LIMIT_VIOLATION


def test_an_estop_is_kept_until_errors_are_cleared(odrive: ODriveSettings):
    riding = Riding(odrive)
    feed = set_input_torque(3, 0.5)
    enable = set_axis_state(3, AxisState.CLOSED_LOOP_CONTROL)
    riding.tick(estop(3), feed, enable)
    assert riding.device.torque == 0.0
    riding.tick(clear_errors(3), feed)
    assert riding.device.torque == 0.0
    riding.tick(enable, feed)
    assert riding.device.torque == 0.5


def test_it_sends_what_it_should_as_often_as_it_should(odrive: ODriveSettings):
    riding = Riding(odrive)
    riding.device.angle, riding.device.rate = math.tau, -math.pi
    for _ in range(1000):
        riding.tick(set_input_torque(3, 0.25))
    estimates = riding.came(Command.GET_ENCODER_ESTIMATES)
    assert len(estimates) == pytest.approx(1000, abs=2)
    assert struct.unpack("<ff", estimates[-1]) == (1.0, -0.5)
    assert len(riding.came(Command.HEARTBEAT)) == pytest.approx(100, abs=2)
    torques = riding.came(Command.GET_TORQUES)
    assert len(torques) == pytest.approx(500, abs=2)
    assert unpack_torques(torques[-1]) == (0.25, 0.25)


def test_frames_for_others_are_not_its_own(odrive: ODriveSettings):
    riding = Riding(odrive)
    riding.tick(estop(4))
    assert riding.device.torque == 0.5
