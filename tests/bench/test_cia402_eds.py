"""Makers' EDS files: read as they write them, or refused in one line; so what does not fit them."""

from pathlib import Path

import pytest

from bikesim.bench.cia402 import State
from bikesim.bench.cia402_settings import Cia402Settings, DriveObject
from bikesim.bench.cia402_setup import DriveReport, set_up
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.motor import Motor
from bikesim.errors import InputError

from .conftest import Wire

SHUTDOWN_OPTION = """
[605B]
ParameterName=Shutdown option code
DataType=0x0003
AccessType=rw
"""


class Maker:
    """Writes EDS files: the one that ships, changed."""

    def __init__(self, shipped: Path, folder: Path) -> None:
        self.text, self._folder = shipped.read_text(), folder

    def add(self, text: str) -> None:
        self.text += text

    def write(self, encoding: str = "utf-8") -> str:
        return self.write_bytes(self.text.encode(encoding))

    def write_bytes(self, content: bytes, name: str = "maker.eds") -> str:
        path = self._folder / name
        path.write_bytes(content)
        return str(path)


@pytest.fixture
def maker(repository: Path, tmp_path: Path) -> Maker:
    return Maker(repository / "hardware" / "can" / "cia402_drive.eds", tmp_path)


def refused(wire: Wire, drive: Cia402Settings) -> str:
    device = EmulatedDrive(drive.node, Motor.of_profile(drive))
    with wire.with_devices(device) as bus, pytest.raises(InputError) as error:
        set_up(bus, drive)
    assert "\n" not in str(error.value)
    assert device.state is State.SWITCH_ON_DISABLED
    return str(error.value)


def set_up_one(wire: Wire, drive: Cia402Settings) -> DriveReport:
    with wire.with_devices(EmulatedDrive(drive.node, Motor.of_profile(drive))) as bus:
        return set_up(bus, drive)


def object_of(index: int, subindex: int, value: int) -> DriveObject:
    return DriveObject(index=index, subindex=subindex, value=value)


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (object_of(0x1802, 2, 256), "1802:02 (from the profile) = 256 does not fit its type in"),
        (object_of(0x1802, 2, 256), "0 to 255 are allowed"),
        (object_of(0x605B, 0, -40000), "-32768 to 32767 are allowed"),
        (object_of(0x1008, 0, 5), "1008:00 (from the profile) is no whole number in"),
        (object_of(0x2000, 0, 5), "has no 2000:00"),
        # One without subindices is itself under none but 0: this would be the controlword.
        (object_of(0x6040, 5, 15), "has no 6040:05"),
    ],
    ids=["too large", "its range", "negative", "text", "not in it", "controlword"],
)
def test_an_object_that_cannot_be_written_is_named(
    wire: Wire, drive: Cia402Settings, maker: Maker, more: DriveObject, told: str
):
    maker.add(SHUTDOWN_OPTION)
    profile = drive.model_copy(update={"objects": (more,), "eds": maker.write()})
    assert told in refused(wire, profile)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_an_eds_in_a_makers_encoding(
    wire: Wire, drive: Cia402Settings, maker: Maker, encoding: str
):
    maker.text = maker.text.replace("Motor rated torque", "Rated torque, Drive® [µNm]")
    profile = drive.model_copy(update={"eds": maker.write(encoding)})
    assert set_up_one(wire, profile).rated_torque == pytest.approx(0.386)


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"garbage\nand more of it\n", "maker.eds"),
        (bytes(range(256)), "maker.eds"),
        (b"[DeviceInfo]\n[1000]\nObjectType=7\n", "maker.eds"),
        (b"[DeviceInfo]\n[1018sub1]\nParameterName=a\nDataType=7\nAccessType=ro\n", "maker.eds"),
        (b"<?xml version='1.0'?>\n<ISO15745ProfileContainer/>\n", "maker.xdd"),
    ],
    ids=["text", "binary", "no name", "no index", "xdd"],
)
def test_what_is_no_eds_is_one_line(
    wire: Wire, drive: Cia402Settings, maker: Maker, content: bytes, name: str
):
    profile = drive.model_copy(update={"eds": maker.write_bytes(content, name)})
    told = refused(wire, profile)
    assert name in told
    assert "cannot be read as an EDS" in told


def test_an_object_of_another_length_than_the_eds_has_it(
    wire: Wire, drive: Cia402Settings, maker: Maker
):
    before, after = maker.text.split("[6502]")
    maker.text = f"{before}[6502]{after.replace('0x0007', '0x001B')}"  # 64 bits for 32
    profile = drive.model_copy(update={"eds": maker.write()})
    assert "has 6502:00 in another length than" in refused(wire, profile)
