"""The set-up against the emulated drive, over a bus: what it leaves, and what it refuses."""

from collections.abc import Callable

import canopen
import pytest

from bikesim.bench.cia402 import NmtState, State
from bikesim.bench.cia402_drive import Cia402Drive
from bikesim.bench.cia402_frames import (
    SYNC,
    CobIds,
    DriveCommand,
    heartbeat,
    pack_command,
    unpack_motion,
    unpack_status,
)
from bikesim.bench.cia402_settings import Cia402Settings, DriveObject
from bikesim.bench.cia402_setup import DriveReport, set_up
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.frame import Frame
from bikesim.errors import InputError

from .conftest import Wire, variable

# The emulated drive has two RPDOs and three TPDOs, of four each.
ABSENT = (0x6007, 0x605E, 0x605A, 0x1029, 0x608F, 0x60B2)
MISSING_PDOS = ("1402:01 (RPDO3", "1403:01 (RPDO4", "1803:01 (TPDO4")


def emulated(drive: Cia402Settings, **changes) -> EmulatedDrive:
    return EmulatedDrive(drive.node, Motor.of_profile(drive), **changes)


def refused(wire: Wire, device: EmulatedDrive, drive: Cia402Settings) -> str:
    with wire.with_devices(device) as bus, pytest.raises(InputError) as error:
        set_up(bus, drive)
    assert "\n" not in str(error.value)
    assert device.torque == 0.0
    assert device.state is not State.OPERATION_ENABLED
    return str(error.value)


def set_up_one(wire: Wire, device: EmulatedDrive, drive: Cia402Settings) -> DriveReport:
    with wire.with_devices(device) as bus:
        return set_up(bus, drive)


def test_what_it_leaves(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    report = set_up_one(wire, device, drive)
    assert report[:4] == ("CiA 402 drive", 0, 0, pytest.approx(0.386))
    assert report.missing == tuple(f"{index} off)" for index in MISSING_PDOS)
    assert (device.nmt, device.state) == (NmtState.OPERATIONAL, State.SWITCH_ON_DISABLED)
    held = {
        (0x1016, 1): 127 << 16 | 30, (0x1017, 0): 10, (0x6007, 0): 1, (0x605E, 0): 0,
        (0x6060, 0): 10, (0x6061, 0): 10, (0x6071, 0): 0,
        (0x6072, 0): 1648,  # 3.5 N m / (5.5 * 0.386 N m), rounded down
        (0x6080, 0): 420,  # 8 rad/s * 5.5 in rpm
        (0x1400, 1): 0x205, (0x1800, 1): 0x185, (0x1801, 1): 0x285,
        (0x1401, 1): 0x80000305, (0x1802, 1): 0x80000385,
    }  # fmt: skip
    assert {key: device.objects.get(*key) for key in held} == held


def enabled(device: EmulatedDrive, drive: Cia402Settings, torque: int) -> list[Frame]:
    """Brought to "operation enabled" by the loop's frames; what the last SYNC gave."""
    ids = CobIds.of_node(drive.node)
    for controlword in (0x06, 0x07, 0x0F, 0x0F):
        command = DriveCommand(controlword, torque, 10)
        device.receive(heartbeat(drive.host_node), 100.0)
        device.receive(Frame(ids.command, pack_command(command)), 100.0)
    return device.receive(SYNC, 100.0)


def test_the_loops_frames_fit_what_was_mapped(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    set_up_one(wire, device, drive)
    device.angle, device.rate = 3.0, -7.0
    status, motion = enabled(device, drive, -100)
    assert (status.id, motion.id) == (0x185, 0x285)
    told = unpack_status(status.data)
    moved = unpack_motion(motion.data)
    assert told
    assert moved
    assert told.torque == -100
    assert drive.scale.torque(told.torque) == pytest.approx(-0.1 * 0.386 * 5.5)
    assert device.torque == pytest.approx(-0.0386)
    assert drive.scale.steer(told.position) == pytest.approx(3.0 / 5.5, abs=2e-4)
    assert drive.scale.steer_rate(moved.velocity) == pytest.approx(-7.0 / 5.5, abs=0.01)
    assert (moved.mode, moved.error) == (10, 0)


def test_the_drive_keeps_to_its_limit_whatever_is_sent(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    set_up_one(wire, device, drive)
    enabled(device, drive, 32767)
    assert device.torque * drive.gear == pytest.approx(3.5, abs=0.003)
    assert device.torque * drive.gear <= 3.5


def test_the_drive_does_not_drive_beyond_its_speed(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    set_up_one(wire, device, drive)
    device.rate = 8.1 * drive.gear
    enabled(device, drive, 500)
    assert device.torque == 0.0
    enabled(device, drive, -500)  # it may still be braked
    assert device.torque == pytest.approx(-0.193)


def test_a_second_time_and_after_a_fault_it_is_set_up_again(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    with wire.with_devices(device) as bus:
        first = set_up(bus, drive)
        assert first.fault == ""
        device.fail(0x2310, 0.0)
        again = set_up(bus, drive)
        assert again == first._replace(fault="it was in fault 0x2310 (over current), reset now")
    assert device.state is State.SWITCH_ON_DISABLED


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (0x8130, "its host had gone (error 0x8130), reset now"),
        (0x7121, "it was in fault 0x7121 (motor blocked), reset now"),
        (0x4299, "it was in fault 0x4299 (device temperature), reset now"),  # a class of CiA 301
        (0xA000, "it was in fault 0xa000, reset now"),
    ],
    ids=str,
)
def test_a_fault_in_which_it_is_found_is_told(
    wire: Wire, drive: Cia402Settings, error: int, told: str
):
    device = emulated(drive)
    device.fail(error, 0.0)
    with wire.with_devices(device) as bus:
        lines = Cia402Drive(drive).set_up(bus, prove=False)
    assert told in lines
    assert device.state is State.SWITCH_ON_DISABLED


def test_a_torque_offset_that_is_stored_in_it_is_undone(wire: Wire, drive: Cia402Settings):
    device = emulated(drive)
    device.objects.set(0x60B2, 0, 250)
    set_up_one(wire, device, drive)
    enabled(device, drive, 0)
    assert (device.objects.get(0x60B2), device.torque) == (0, 0.0)


def test_a_torque_offset_of_the_profile_is_refused(drive: Cia402Settings):
    offset = {"index": 0x60B2, "value": 100}
    with pytest.raises(InputError, match=r"60B2:00 \(torque offset\) is the set-up's own"):
        Cia402Settings.model_validate(drive.model_dump() | {"objects": [offset]})


def test_a_drive_without_what_it_need_not_have(wire: Wire, drive: Cia402Settings):
    device = emulated(drive, without=(*ABSENT, 0x1401, 0x1802))
    report = set_up_one(wire, device, drive)
    assert {int(name[:4], 16) for name in report.missing} >= {*ABSENT}


@pytest.mark.parametrize("index", [0x1016, 0x6072, 0x6080, 0x1801])
def test_a_drive_without_what_it_must_have(wire: Wire, drive: Cia402Settings, index: int):
    told = refused(wire, emulated(drive, without=(index,)), drive)
    assert f"refused {index:04X}:" in told
    assert "Object does not exist" in told


def test_nobody_answers(wire: Wire, drive: Cia402Settings):
    with wire.host() as bus, pytest.raises(InputError, match="drive 5: does not answer"):
        set_up(bus, drive)


def test_another_unit_of_torque_than_the_profiles(wire: Wire, drive: Cia402Settings):
    other = drive.model_copy(update={"torque_unit": "mNm"})
    assert "set torque_unit" in refused(wire, emulated(other), drive)


def test_another_encoder_than_the_profiles(wire: Wire, drive: Cia402Settings):
    other = drive.model_copy(update={"encoder_counts": 2000})
    assert "2000 encoder counts" in refused(wire, emulated(other), drive)


def changed(index: int, subindex: int, value: int) -> Callable[[EmulatedDrive], None]:
    return lambda device: device.objects.set(index, subindex, value)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (changed(0x1000, 0, 0x191), "is no CiA 402 drive"),
        (changed(0x6502, 0, 0x1FF), "no cyclic synchronous torque mode"),
        (changed(0x1018, 1, 7), "has vendor_id 0x7, the profile 0x9"),
        (
            lambda d: d.fail(0x3210, 0.0, remains=True),
            "stays in fault, error 0x3210 (DC link over-voltage)",
        ),
    ],
)
def test_a_drive_that_is_not_as_it_should_be(
    wire: Wire, drive: Cia402Settings, change: Callable[[EmulatedDrive], None], told: str
):
    device = emulated(drive)
    device.objects.set(0x1018, 1, 9)
    change(device)
    profile = drive.model_copy(update={"vendor_id": 9})
    assert told in refused(wire, device, profile)


class Forgetful(EmulatedDrive):
    """Takes a limit and does not keep it."""

    def _written(self, index: int, subindex: int, value: int) -> None:
        super()._written(index, subindex, value)
        if index == 0x6072:
            self.objects.set(0x6072, 0, 5000)


def test_what_is_not_kept_is_seen(wire: Wire, drive: Cia402Settings):
    device = Forgetful(drive.node, Motor.of_profile(drive))
    told = refused(wire, device, drive)
    assert "6072:00 (largest torque) = 5000 after 1648 was written" in told


def test_an_object_of_the_profile_is_written_too(wire: Wire, drive: Cia402Settings):
    more = DriveObject(index=0x1802, subindex=2, value=5)
    device = emulated(drive)
    set_up_one(wire, device, drive.model_copy(update={"objects": (more,)}))
    assert device.objects.get(0x1802, 2) == 5


def test_canopens_own_node_accepts_what_is_written(wire: Wire, drive: Cia402Settings, repository):
    """An independent SDO server on the same EDS: types, sizes and objects are those of it."""
    network = canopen.Network()
    network.NOTIFIER_CYCLE = 0.02
    network.connect(interface="virtual", channel=wire.name)
    eds = str(repository / "hardware" / "can" / "cia402_drive.eds")
    local = network.create_node(drive.node, eds)
    variable(local.sdo, 0x6076).raw, local.nmt.state = 386000, "PRE-OPERATIONAL"
    local.nmt.start_heartbeat(20)
    try:
        with wire.host() as bus:
            report = set_up(bus, drive)
        assert variable(local.sdo, 0x1016, 1).raw == 127 << 16 | 30
        assert variable(local.sdo, 0x1A01, 3).raw == 0x603F0010
    finally:
        local.nmt.stop_heartbeat()
        network.disconnect()
    assert len(report.missing) == len(MISSING_PDOS)
