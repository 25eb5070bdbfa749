"""Commands that end with one line and exit status 2, on a bus with devices; no torque is sent."""

import math
import time
import tomllib
from contextlib import AbstractContextManager
from pathlib import Path

import can
import pytest
import tomli_w

from bikesim.bench import calibrate_bench
from bikesim.bench.calibration import NodeCalibration
from bikesim.bench.calibration_kept import keep_calibration
from bikesim.bench.cia402 import State
from bikesim.bench.cia402_frames import DriveCommand, pack_command
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION, EmulatedSteerNode
from bikesim.bench.frame import Frame
from bikesim.bench.profile import BenchSettings, load_bench
from bikesim.cli.bench import calibrate as calibrate_command
from bikesim.cli.main import main

from .conftest import Wire
from .handled import HandledBar, Person
from .lockstep import CIA402

COMMAND = 0x205


class Other:
    """Another host, which commands the same drive now and then."""

    torque = 0.0

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        return []

    def advance(self, time: float) -> list[Frame]:
        return [Frame(COMMAND, pack_command(DriveCommand(6, 0, 10)))]


class Desk:
    """A folder with a profile, devices on its bus, and all that anybody sends to the drive."""

    def __init__(self, wire: Wire, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self._wire, self._capsys = wire, capsys
        self.path = folder / "bench.toml"
        self.write()

    def write(self, bar: dict | None = None, **drive: object) -> None:
        """The profile; `drive`: other entries than those of the drive that is there."""
        tables = {
            "bus": {"interface": "virtual", "channel": self._wire.name},
            "bar": {"inertia": 0.2311, "delay": 0.002, **(bar or {})},
            "drive": {**CIA402, "heartbeat_timeout": 0.2, **drive},
        }
        self.path.write_text(tomli_w.dumps(tables))

    def on_the_bus(self, *devices: Device) -> AbstractContextManager[can.BusABC]:
        return self._wire.with_devices(*devices)

    def refused(self, *arguments: str, devices: tuple[Device, ...]) -> str:
        """The line with which a command is refused."""
        with can.Bus(interface="virtual", channel=self._wire.name) as tap:
            with self._wire.with_devices(*devices):
                time.sleep(0.02)
                status = main(["bench", *arguments])
            sent = list(iter(lambda: tap.recv(0), None))
        said = self._capsys.readouterr()
        assert status == 2
        assert said.err.startswith("bikesim: ")
        assert said.err.count("\n") == 1
        torques = [one.data[2:4] for one in sent if one.arbitration_id == COMMAND]
        assert all(bytes(one) == b"\0\0" for one in torques)
        assert sorted(one.name for one in self.path.parent.iterdir()) == ["bench.toml"]
        return said.err


@pytest.fixture
def desk(wire: Wire, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch) -> Desk:
    monkeypatch.chdir(tmp_path)
    return Desk(wire, tmp_path, capsys)


def drive(**entries: object) -> EmulatedDrive:
    settings = Cia402Settings(**{**CIA402, **entries})
    return EmulatedDrive(settings.node, Motor.of_profile(settings))


RUN = ("run", "bench.toml", "--uncommissioned", "-o", "r.h5")


@pytest.mark.parametrize("command", [RUN, ("identify", "bench.toml")], ids=lambda one: one[0])
def test_two_masters(desk: Desk, command: tuple[str, ...], monkeypatch):
    monkeypatch.setattr("bikesim.cli.bench.identify.ask", lambda question: "")
    said = desk.refused(*command, devices=(EmulatedSteerNode(), drive(), Other()))
    assert "fault 24: somebody else sends 0x205, which is this host's to send" in said


@pytest.mark.parametrize("command", [RUN, ("identify", "bench.toml")], ids=lambda one: one[0])
def test_the_emergency_stop_is_open_so_the_drive_has_no_power(
    desk: Desk, command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("bikesim.cli.bench.identify.ask", lambda question: "")
    node = EmulatedSteerNode()
    node.estop_closed = False
    said = desk.refused(*command, devices=(node,))
    assert said == "bikesim: fault 21: the emergency stop is open: close it first\n"


def test_units_that_contradict_the_nameplate(desk: Desk):
    desk.write(torque_unit="mNm")
    said = desk.refused(*RUN, devices=(EmulatedSteerNode(), drive()))
    assert "its unit is uNm, set torque_unit" in said


def test_an_encoder_that_contradicts_the_profile(desk: Desk):
    desk.write(encoder_counts=8192)
    said = desk.refused(*RUN, devices=(EmulatedSteerNode(), drive()))
    assert "4096" in said
    assert "8192" in said


def test_a_node_with_another_calibration(desk: Desk):
    """As one that was replaced: nothing is sent to the drive, not even its set-up."""
    desk.write(bar={"calibration": list(USUAL_CALIBRATION.counts())})
    mirrored = USUAL_CALIBRATION._replace(angle_scale=-5.76)
    device = Watched(Cia402Settings(**CIA402))
    said = desk.refused(*RUN, devices=(EmulatedSteerNode(stored=mirrored), device))
    assert "fault 22: the sensor node's calibration is not this profile's: angle scale" in said
    assert device.heard == {0x112}


@pytest.mark.parametrize("key", [True, False], ids=["checked", "not checked"])
def test_a_node_with_the_calibration_of_the_profile_or_of_none(desk: Desk, key: bool, capsys):
    """Refused for another cause, which comes later."""
    bar = {"calibration": list(USUAL_CALIBRATION.counts())} if key else {}
    desk.write(bar=bar, torque_unit="mNm")
    with desk.on_the_bus(EmulatedSteerNode(), drive()):
        assert main(["bench", *RUN]) == 2
    said = capsys.readouterr()
    assert "its unit is uNm" in said.err
    told = "node     its calibration is not checked: the profile has no bar.calibration"
    assert (told in said.out) is not key


def test_no_drive_where_only_the_drive_would_speak(desk: Desk):
    """Without a node a bench is silent before it is asked, which is no fault yet."""
    desk.write(bar={"source": "drive"})
    said = desk.refused(*RUN, devices=())
    assert "drive 5" in said
    assert "answer" in said


def test_a_drive_on_another_node(desk: Desk):
    said = desk.refused(*RUN, devices=(EmulatedSteerNode(), drive(node=6)))
    assert "drive 5" in said


def test_no_sensor_node(desk: Desk):
    assert "nobody sends 0x110" in desk.refused(*RUN, devices=(drive(), Beating()))


class Beating(Other):
    """The drive's heartbeat, which a drive that was set up before still sends."""

    def advance(self, time: float) -> list[Frame]:
        return [Frame(0x705, b"\x7f")]


class TestCalibration:
    """In simulated time: a person takes some 15 s."""

    @pytest.fixture
    def node(self, monkeypatch: pytest.MonkeyPatch, wire: Wire) -> HandledBar:
        node = HandledBar(noise=2e-4)
        link = SimulatedLink([node])

        def bus(bench: BenchSettings) -> tuple[can.BusABC, SimulatedLink]:
            return can.Bus(interface="virtual", channel=wire.name), link

        monkeypatch.setattr(calibrate_bench, "on_node_bus", bus)
        return node

    @pytest.mark.parametrize(
        ("off", "line"),
        [
            ({"+0": 6.0}, "the position 0 deg is +4.0 deg off the line through all: allowed 1"),
            ({"-30": 60.0, "+30": -60.0}, "the angle scale would be -0."),
        ],
        ids=["one read wrongly", "left and right mixed up"],
    )
    def test_one_that_does_not_fit(
        self, desk: Desk, node: HandledBar, monkeypatch, off: dict, line: str
    ):
        monkeypatch.setattr(calibrate_command, "ask", Person(node, off=off))
        assert line in desk.refused("calibrate", "bench.toml", "--yes", devices=())
        assert node.stored == USUAL_CALIBRATION

    def test_one_that_fits_keeps_the_old_one(self, desk: Desk, node: HandledBar, monkeypatch):
        mark = load_bench(str(desk.path)).commissioning
        desk.path.write_text(f'commissioned = "{mark}"\n{desk.path.read_text()}')
        monkeypatch.setattr(calibrate_command, "ask", Person(node))
        assert main(["bench", "calibrate", "bench.toml", "--yes"]) == 0
        assert node.stored is not None
        assert node.stored.angle_scale == pytest.approx(node.sensors.angle_scale, rel=2e-3)
        (kept,) = desk.path.parent.glob("*.node.*.bak")
        after = load_bench(str(desk.path))
        assert after.commissioned == ""
        assert after.bar.calibration == node.stored.counts()
        old = tomllib.loads(kept.read_text())
        assert NodeCalibration(**old) == pytest.approx(USUAL_CALIBRATION, abs=1e-4)

    def test_the_old_one_is_put_back(self, desk: Desk, node: HandledBar, monkeypatch):
        """By its file; with the key, and without the mark."""
        wanted = NodeCalibration(0.47, -5.2, 0.512, 9.6, 3.3)
        kept = keep_calibration(desk.path, wanted)
        mark = load_bench(str(desk.path)).commissioning
        desk.path.write_text(f'commissioned = "{mark}"\n{desk.path.read_text()}')
        restore = ["bench", "calibrate", "bench.toml", "--restore", str(kept)]
        monkeypatch.setattr(calibrate_command, "ask", lambda question: "n")
        assert main(restore) == 0
        assert node.stored == USUAL_CALIBRATION
        assert load_bench(str(desk.path)).commissioned == mark
        assert main([*restore, "--yes"]) == 0
        assert node.stored is not None
        assert node.stored.counts() == wanted.counts()
        after = load_bench(str(desk.path))
        assert (after.commissioned, after.bar.calibration) == ("", wanted.counts())

    def test_nothing_is_put_back_while_the_drive_may_have_power(
        self, desk: Desk, node: HandledBar, tmp_path: Path, capsys
    ):
        kept = keep_calibration(tmp_path / "other.toml", USUAL_CALIBRATION)
        before = desk.path.read_text()
        node.estop_closed = True
        command = ["bench", "calibrate", "bench.toml", "--yes", "--restore", str(kept)]
        assert main(command) == 2
        assert "press the emergency stop first" in capsys.readouterr().err
        assert desk.path.read_text() == before


class Watched(EmulatedDrive):
    """Remembers what it was while it was asked."""

    def __init__(self, drive: Cia402Settings) -> None:
        super().__init__(drive.node, Motor.of_profile(drive))
        self.was: set[State] = set()
        self.heard: set[int] = set()

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        self.heard.add(frame.id)
        self.was.add(self.state)
        return super().receive(frame, time)


def test_an_encoder_is_calibrated_without_enabling_the_drive(desk: Desk, wire: Wire, monkeypatch):
    """A person holds the bar; and what the pulse proved is proven no more."""
    desk.write(bar={"source": "drive"})
    mark = load_bench(str(desk.path)).commissioning
    desk.path.write_text(f'commissioned = "{mark}"\n{desk.path.read_text()}')
    device = Watched(Cia402Settings(**{**CIA402, "heartbeat_timeout": 0.2}))

    def turned(question: str) -> str:
        degrees = float(question.removeprefix("turn the bar to ").partition(" deg")[0])
        device.angle = 5.5 * (math.radians(degrees) + 0.25)
        time.sleep(0.05)
        return ""

    monkeypatch.setattr(calibrate_command, "ask", turned)
    with wire.with_devices(device):
        assert main(["bench", "calibrate", "bench.toml", "--yes", "--positions", "-30,30"]) == 0
    after = load_bench(str(desk.path))
    assert after.bar.drive_zero == pytest.approx(0.25, abs=1e-3)
    assert after.commissioned == ""
    assert State.SWITCH_ON_DISABLED in device.was
    assert not device.was & {State.SWITCHED_ON, State.OPERATION_ENABLED}


def test_no_permission(desk: Desk, monkeypatch):
    """As the system says it of an interface or a serial line that is not this person's."""

    def refuse(*args: object, **kwargs: object) -> None:
        raise PermissionError(13, "Permission denied")

    desk.path.write_text(desk.path.read_text().replace('"virtual"', '"slcan"'))
    monkeypatch.setattr("serial.serialposix.os.open", refuse)
    said = desk.refused(*RUN, devices=())
    assert "cannot be opened" in said
    assert "Permission denied" in said
