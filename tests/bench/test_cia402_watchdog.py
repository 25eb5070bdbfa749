"""What the emulated drive does when the host falls silent, and whether the host finds out."""

import pytest

from bikesim.bench.cia402 import HEARTBEAT_LOST, NmtCommand, NmtState, State
from bikesim.bench.cia402_frames import (
    SYNC,
    CobIds,
    DriveCommand,
    heartbeat,
    nmt,
    pack_command,
    unpack_emergency,
    unpack_heartbeat,
    unpack_motion,
)
from bikesim.bench.cia402_objects import Write, set_up_writes
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.cia402_watchdog import prove_watchdog
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.frame import Frame
from bikesim.errors import InputError

from .conftest import Wire


def ready(drive: Cia402Settings, but: tuple[Write, ...] = ()) -> EmulatedDrive:
    return set_up_as_it_should_be(EmulatedDrive(drive.node, Motor.of_profile(drive)), drive, but)


def set_up_as_it_should_be(
    device: EmulatedDrive, drive: Cia402Settings, but: tuple[Write, ...] = ()
) -> EmulatedDrive:
    """`But` for some objects; operational."""
    device.advance(0.0)
    for write in (*set_up_writes(drive), *but):
        if (write.index, write.subindex) in device.objects:
            device.objects.set(write.index, write.subindex, write.value)
            device._written(write.index, write.subindex, write.value)
    device.receive(nmt(NmtCommand.START, drive.node), 0.0)
    return device


def test_a_drive_that_disables_itself_passes(drive: Cia402Settings):
    device = ready(drive)
    after = prove_watchdog(SimulatedLink([device]), drive)
    assert 0.030 < after <= 0.035
    assert device.state is State.SWITCH_ON_DISABLED


@pytest.mark.parametrize(
    "but",
    [
        Write(0x1016, 1, 0, "never set"),
        Write(0x1016, 1, 126 << 16 | 30, "of another host"),
        Write(0x1016, 1, 127 << 16 | 60, "too long"),
        Write(0x6007, 0, 0, "a lost heartbeat is no fault"),
    ],
    ids=lambda write: write.why,
)
def test_a_drive_that_goes_on_is_found_out_and_disabled(drive: Cia402Settings, but: Write):
    device = ready(drive, (but,))
    with pytest.raises(InputError, match=r"is still enabled 0\.0\d\d s after the host's last"):
        prove_watchdog(SimulatedLink([device]), drive)
    assert device.state is State.SWITCH_ON_DISABLED
    assert device.torque == 0.0


def test_a_drive_that_cannot_be_enabled(drive: Cia402Settings):
    device = ready(drive)
    device.fail(0x3210, 0.0, remains=True)
    with pytest.raises(InputError, match="stays in fault, should be operation enabled"):
        prove_watchdog(SimulatedLink([device]), drive)


class Watched(EmulatedDrive):
    """Keeps for how many frames it was enabled."""

    enabled = 0

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        sent = super().receive(frame, time)
        self.enabled += self.state is State.OPERATION_ENABLED
        return sent


def at_rest_refused(device: EmulatedDrive, drive: Cia402Settings, told: str) -> None:
    with pytest.raises(InputError, match=told):
        prove_watchdog(SimulatedLink([set_up_as_it_should_be(device, drive)]), drive)
    assert device.state is State.SWITCH_ON_DISABLED
    assert device.torque == 0.0


def test_a_drive_that_measures_a_torque_is_not_enabled(drive: Cia402Settings):
    device = Watched(drive.node, Motor.of_profile(drive))
    device.offset = -0.11 / drive.gear
    at_rest_refused(device, drive, r"fault 25: the drive measures -0\.11 N m before it is told any")
    assert device.enabled == 0


def test_the_torque_of_noise_is_allowed(drive: Cia402Settings):
    device = ready(drive)
    device.offset = 0.09 / drive.gear
    assert prove_watchdog(SimulatedLink([device]), drive) > 0.030


def test_an_offset_that_nobody_could_undo_is_disabled_at_once(drive: Cia402Settings):
    """250 per mille of 0.386 N m, at 5.5 turns for one; 60B2 cannot be reached."""
    device = Watched(drive.node, Motor.of_profile(drive), without=(0x60B2,))
    device.objects.set(0x60B2, 0, 250)
    at_rest_refused(device, drive, r"fault 25: the drive measures \+0\.53 N m .* allowed 0\.1 N m")
    assert 0 < device.enabled <= 4  # of one cycle: heartbeat, command, SYNC


def test_a_drive_that_is_not_there(drive: Cia402Settings):
    with pytest.raises(InputError, match="stays in unknown"):
        prove_watchdog(SimulatedLink([]), drive)


def test_over_a_bus(wire: Wire, drive: Cia402Settings):
    """In real time; 0.2 s, for a machine that has other things to do."""
    from bikesim.bench.cia402_setup import set_up
    from bikesim.bench.link import BusLink

    slow = drive.model_copy(update={"heartbeat_timeout": 0.2})
    device = EmulatedDrive(slow.node, Motor.of_profile(slow))
    with wire.with_devices(device) as bus:
        set_up(bus, slow)
        assert prove_watchdog(BusLink(bus), slow) > 0.19
        assert device.state is State.SWITCH_ON_DISABLED


class Riding:
    """A drive that is enabled and gives torque, millisecond by millisecond."""

    def __init__(self, drive: Cia402Settings, torque: int = 500) -> None:
        self.drive, self.device, self.now = drive, ready(drive), 0.0
        self.sent: list[Frame] = []
        for controlword in (0x06, 0x07, 0x0F):
            self.tick(controlword, torque)
        assert self.device.torque == pytest.approx(torque * 386e-6)

    def tick(self, controlword: int = 0x0F, torque: int = 500) -> None:
        command = pack_command(DriveCommand(controlword, torque, 10))
        frames = (
            heartbeat(self.drive.host_node),
            Frame(CobIds.of_node(self.drive.node).command, command),
        )
        for frame in frames:
            self.sent += self.device.receive(frame, self.now)
        self.silent_tick()

    def silent_tick(self) -> None:
        self.now += 0.001
        self.sent += self.device.advance(self.now)

    def came(self, identifier: int) -> list[bytes]:
        return [frame.data for frame in self.sent if frame.id == identifier]


def test_a_host_that_is_killed_leaves_no_torque_after_its_timeout(drive: Cia402Settings):
    riding = Riding(drive)
    killed = riding.now
    while riding.device.torque:
        riding.silent_tick()
    assert riding.now - killed == pytest.approx(0.030, abs=0.0015)
    emergencies = [unpack_emergency(data) for data in riding.came(0x085)]
    assert [one.error for one in emergencies if one] == [HEARTBEAT_LOST]


def test_pdos_without_heartbeats_do_not_keep_the_torque(drive: Cia402Settings):
    riding = Riding(drive)
    command = Frame(0x205, pack_command(DriveCommand(0x0F, 500, 10)))
    for _ in range(40):
        riding.device.receive(command, riding.now)
        riding.device.receive(SYNC, riding.now)
        riding.silent_tick()
    assert riding.device.torque == 0.0


def test_after_a_fault_it_stays_off_until_it_is_reset(drive: Cia402Settings):
    riding = Riding(drive)
    riding.device.fail(0x2310, riding.now)
    assert riding.device.torque == 0.0
    for _ in range(10):
        riding.tick()
    assert riding.device.state is State.FAULT
    (_, motion) = riding.device.receive(SYNC, riding.now)
    moved = unpack_motion(motion.data)
    assert moved
    assert moved.error == 0x2310
    for controlword in (0x80, 0x06, 0x07, 0x0F):
        riding.tick(controlword)
    assert riding.device.torque > 0
    emergencies = [unpack_emergency(data) for data in riding.came(0x085)]
    assert [one.error for one in emergencies if one] == [0x2310, 0]


@pytest.mark.parametrize("controlword", [0x00, 0x02, 0x06, 0x07], ids=hex)
def test_no_torque_outside_operation_enabled(drive: Cia402Settings, controlword: int):
    riding = Riding(drive)
    riding.tick(controlword)
    assert riding.device.torque == 0.0


def test_no_torque_in_another_mode(drive: Cia402Settings):
    riding = Riding(drive)
    riding.device.receive(Frame(0x205, pack_command(DriveCommand(0x0F, 500, 9))), riding.now)
    assert riding.device.torque == 0.0


def test_a_command_that_is_cut_short_is_refused_with_an_emergency(drive: Cia402Settings):
    riding = Riding(drive, torque=100)
    sent = riding.device.receive(Frame(0x205, bytes.fromhex("0f00e803")), riding.now)
    assert riding.device.torque == pytest.approx(0.0386)
    told = unpack_emergency(sent[0].data)
    assert told
    assert told.error == 0x8210


def test_its_own_heartbeats(drive: Cia402Settings):
    riding = Riding(drive)
    del riding.sent[:]
    for _ in range(100):
        riding.tick()
    states = [unpack_heartbeat(data) for data in riding.came(0x705)]
    assert len(states) == pytest.approx(10, abs=1)
    assert set(states) == {NmtState.OPERATIONAL}


def test_it_says_that_it_has_started(drive: Cia402Settings):
    device = EmulatedDrive(5, Motor.of_profile(drive))
    assert device.advance(0.0) == [Frame(0x705, b"\0")]
    device.receive(nmt(NmtCommand.RESET_NODE, 5), 1.0)
    assert device.advance(1.0) == [Frame(0x705, b"\0")]


def test_commands_for_others_are_not_its_own(drive: Cia402Settings):
    riding = Riding(drive)
    riding.device.receive(Frame(0x206, pack_command(DriveCommand(0x00, 0, 10))), riding.now)
    riding.device.receive(nmt(NmtCommand.STOP, 6), riding.now)
    assert riding.device.torque > 0
