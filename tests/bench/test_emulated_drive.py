"""The emulated drive against canopen, which is nobody's but its makers'."""

from collections.abc import Iterator
from pathlib import Path

import canopen
import pytest
from canopen.profiles.p402 import BaseNode402

from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.motor import Motor

from .conftest import Wire, variable


@pytest.fixture
def device(drive: Cia402Settings) -> EmulatedDrive:
    return EmulatedDrive(drive.node, Motor.of_profile(drive))


@pytest.fixture
def node(wire: Wire, device: EmulatedDrive, repository: Path) -> Iterator[BaseNode402]:
    network = canopen.Network()
    eds = str(repository / "hardware" / "can" / "cia402_drive.eds")
    with wire.with_devices(device):
        network.NOTIFIER_CYCLE = 0.02
        network.connect(interface="virtual", channel=wire.name)
        node = BaseNode402(device.node, canopen.import_od(eds, device.node))
        network.add_node(node)
        try:
            yield node
        finally:
            network.disconnect()


def test_reads_and_writes(node: BaseNode402, device: EmulatedDrive):
    assert variable(node.sdo, 0x1008).raw == "CiA 402 drive"  # in segments
    variable(node.sdo, 0x6071).raw = -321
    variable(node.sdo, 0x1016, 1).raw = 0x7F0020
    assert (variable(node.sdo, 0x6071).raw, variable(node.sdo, 0x1016, 1).raw) == (-321, 0x7F0020)
    assert device.objects.get(0x6071) == -321


@pytest.mark.parametrize(
    ("index", "subindex", "data", "code"),
    [
        (0x6041, 0, b"\0\0", 0x06010002),
        (0x6099, 0, b"\0", 0x06020000),
        (0x1016, 2, b"\0\0\0\0", 0x06090011),
        (0x6071, 0, b"\0", 0x06070010),
        (0x1600, 0, b"\1", 0x08000022),  # while the PDO is valid
        (0x1400, 1, b"\x06\x02\0\0", 0x08000022),
    ],
)
def test_what_cannot_be_written_is_refused_as_cia_301_says(
    node: BaseNode402, index: int, subindex: int, data: bytes, code: int
):
    with pytest.raises(canopen.SdoAbortedError) as error:
        node.sdo.download(index, subindex, data)
    assert error.value.code == code


def test_what_does_not_fit_into_a_pdo_is_refused(node: BaseNode402):
    variable(node.sdo, 0x1800, 1).raw = 0x80000185
    variable(node.sdo, 0x1A00, 0).raw = 0
    for number, entry in enumerate((0x60640020, 0x606C0020, 0x60770010), start=1):
        variable(node.sdo, 0x1A00, number).raw = entry
    with pytest.raises(canopen.SdoAbortedError, match="PDO length exceeded"):
        variable(node.sdo, 0x1A00, 0).raw = 3
    with pytest.raises(canopen.SdoAbortedError, match="cannot be mapped"):
        variable(node.sdo, 0x1A00, 1).raw = 0x60760020


def test_canopens_drive_class_brings_it_to_enabled_and_back(
    node: BaseNode402, device: EmulatedDrive
):
    node.TIMEOUT_SWITCH_STATE_FINAL = 2.0
    variable(node.sdo, 0x6060).raw = 10
    variable(node.sdo, 0x6071).raw = 100
    node.setup_402_state_machine(read_pdos=False)
    node.nmt.state = "OPERATIONAL"
    node.state = "OPERATION ENABLED"
    assert device.torque == pytest.approx(0.0386)
    node.state = "SWITCH ON DISABLED"
    assert device.torque == 0.0
