"""An interface that goes down, or a queue that is full, ends each command in one line."""

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
import tomli_w
from can.interfaces.virtual import VirtualBus

from bikesim.bench import calibrate_bench, check, parts
from bikesim.bench.bus import filter_for
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.cia402_watchdog import prove_watchdog
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.emulated.odrive import EmulatedODrive, ODriveConfiguration
from bikesim.bench.emulated.pump import Pump, PumpThread
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.emulator import emulated_bus
from bikesim.bench.frame import Frame
from bikesim.bench.link import BusLink
from bikesim.bench.odrive_settings import ODriveSettings
from bikesim.cli.main import main
from bikesim.errors import InputError

from .conftest import Wire
from .lockstep import CIA402, ODRIVE, profile

DOWN, FULL = "Network is down", "Transmit buffer full"
RUN = ("run", "bench.toml", "--uncommissioned", "-o", "r.h5")


class Broken(VirtualBus):
    """Fails as python-can's own do: from the first look on, once it has sent, or when it sends."""

    def __init__(self, channel: str, broken: str) -> None:
        super().__init__(channel)
        self._broken, self._sent = broken, False

    def recv(self, timeout: float | None = None) -> can.Message | None:
        if self._broken == "recv" or (self._broken == "recv later" and self._sent):
            raise can.CanOperationError(DOWN)
        return super().recv(timeout)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self._broken == "send":
            raise can.CanOperationError(FULL)
        self._sent = True
        super().send(msg, timeout)


class Desk:
    """A profile, and devices on a bus of which the host's side is broken."""

    def __init__(self, wire: Wire, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._wire, self._folder, self._patch = wire, folder, monkeypatch
        self.tracebacks: list[object] = []
        monkeypatch.setattr(threading, "excepthook", self.tracebacks.append)

    def command(self, broken: str, drive: dict, *arguments: str) -> int:
        for module in (parts, check, calibrate_bench):
            self._patch.setattr(module, "open_bus", lambda _: Broken(self._wire.name, broken))
        tables = {
            "bus": {"interface": "virtual", "channel": self._wire.name},
            "bar": {"inertia": 0.2311, "delay": 0.002},
            "drive": drive,
        }
        (self._folder / "bench.toml").write_text(tomli_w.dumps(tables))
        device = (
            EmulatedDrive(5, Motor.of_profile(Cia402Settings(**drive)))
            if drive["kind"] == "cia402"
            else EmulatedODrive(3, ODriveConfiguration.of_profile(ODriveSettings(**drive)))
        )
        with (
            can.Bus(interface="virtual", channel=self._wire.name) as theirs,
            PumpThread(Pump(theirs, (EmulatedSteerNode(), device))),
        ):
            time.sleep(0.02)
            return main(["bench", *arguments])


@pytest.fixture
def desk(wire: Wire, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("bikesim.cli.bench.calibrate.ask", lambda question: "")
    desk = Desk(wire, tmp_path, monkeypatch)
    yield desk
    assert desk.tracebacks == []


@pytest.mark.parametrize(
    ("broken", "drive", "command", "why"),
    [
        ("recv", CIA402, RUN, DOWN),
        ("recv later", CIA402, RUN, DOWN),
        ("recv later", ODRIVE, RUN, DOWN),
        ("send", CIA402, RUN, FULL),
        ("send", ODRIVE, RUN, FULL),
        ("recv", CIA402, ("check", "bench.toml"), DOWN),
        ("recv", CIA402, ("calibrate", "bench.toml", "--yes"), DOWN),
        ("send", CIA402, ("calibrate", "bench.toml", "--yes"), FULL),
    ],
    ids=lambda one: one if isinstance(one, str) else one["kind"] if "kind" in one else one[0],
)
def test_in_one_line(
    desk: Desk,
    capsys: pytest.CaptureFixture[str],
    broken: str,
    drive: dict,
    command: tuple[str, ...],
    why: str,
):
    assert desk.command(broken, drive, *command) == 2
    assert capsys.readouterr().err == f"bikesim: the bus fails: {why}\n"


@pytest.mark.parametrize("drive", [CIA402, ODRIVE], ids=["cia402", "odrive"])
def test_checked_it_is_a_line_of_the_table(
    desk: Desk, capsys: pytest.CaptureFixture[str], drive: dict, monkeypatch: pytest.MonkeyPatch
):
    """Of the drive, which is the first that something is sent to."""
    monkeypatch.setattr(check._Heard, "findings", lambda self: [])
    assert desk.command("send", drive, "check", "bench.toml") == 1
    said = capsys.readouterr()
    assert said.err == ""
    assert f"the bus fails: {FULL}" in said.out


@pytest.mark.parametrize("broken", ["recv", "send"])
def test_while_the_watchdog_is_proven(wire: Wire, drive: Cia402Settings, broken: str):
    with Broken(wire.name, broken) as bus, pytest.raises(InputError, match="the bus fails: "):
        prove_watchdog(BusLink(bus), drive)


def test_a_link_and_a_filter(wire: Wire, monkeypatch: pytest.MonkeyPatch):
    with Broken(wire.name, "send") as bus:
        with pytest.raises(InputError, match=FULL):
            BusLink(bus).send(Frame(0x1))

        def refuse(filters: object) -> None:
            raise OSError(100, DOWN)

        monkeypatch.setattr(bus, "set_filters", refuse)
        with pytest.raises(InputError, match=DOWN):
            filter_for(bus, None)


def test_an_emulated_bench_whose_bus_fails_says_so_in_a_line():
    bench = profile(bus={"interface": "virtual", "channel": "emulated bus that fails"})

    def sent_after_the_end() -> None:
        with emulated_bus(bench.bus) as bus:
            bus.shutdown()
            bus.send(can.Message(arbitration_id=0x110, is_extended_id=False))

    with pytest.raises(InputError, match=r"^the bus fails: "):
        sent_after_the_end()
