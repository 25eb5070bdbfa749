import pytest

from bikesim.bench.cia402 import NmtCommand, NmtState
from bikesim.bench.cia402_frames import (
    CobIds,
    DriveCommand,
    DriveMotion,
    DriveStatus,
    Emergency,
    heartbeat,
    nmt,
    pack_command,
    unpack_emergency,
    unpack_heartbeat,
    unpack_motion,
    unpack_status,
)
from bikesim.bench.frame import Frame


def test_the_command_is_controlword_torque_mode():
    assert pack_command(DriveCommand(0x000F, -2, 10)) == bytes.fromhex("0f00feff0a")


def test_the_status_is_statusword_torque_position():
    assert unpack_status(bytes.fromhex("3712fffffeffffff")) == DriveStatus(0x1237, -1, -2)


def test_the_motion_is_velocity_mode_error():
    assert unpack_motion(bytes.fromhex("feffffff0a3081")) == DriveMotion(-2, 10, 0x8130)


def test_an_emergency():
    data = bytes.fromhex("3081110102030405")
    assert unpack_emergency(data) == Emergency(0x8130, 0x11, bytes((1, 2, 3, 4, 5)))


def test_heartbeat_and_network_management():
    assert heartbeat(127) == Frame(0x77F, b"\x05")
    assert unpack_heartbeat(b"\x7f") is NmtState.PRE_OPERATIONAL
    assert nmt(NmtCommand.START, 5) == Frame(0, b"\x01\x05")


@pytest.mark.parametrize(
    "unpack", [unpack_status, unpack_motion, unpack_emergency, unpack_heartbeat]
)
@pytest.mark.parametrize("data", [b"", bytes(3), bytes(9), b"\x63"], ids=repr)
def test_what_is_none_is_no_error(unpack, data: bytes):
    assert unpack(data) is None


def test_identifiers_of_a_node():
    ids = CobIds.of_node(5)
    assert ids == (0x085, 0x185, 0x205, 0x285, 0x585, 0x605, 0x705)
    assert set(ids.from_drive) | set(ids.to_drive(127)) == {*ids, 0x000, 0x080, 0x77F}
    assert not set(ids.from_drive) & set(ids.to_drive(127))
