"""`bench check` on a bus with emulated devices, each as it is and with something wrong."""

import time
from typing import Any

import can
import pytest

from bikesim.bench import check
from bikesim.bench.cia402 import NmtState
from bikesim.bench.cia402_findings import Said, cia402_findings
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drives import emulated_drive
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.finding import Finding
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import AxisError
from bikesim.bench.odrive_findings import Said as ODriveSaid
from bikesim.bench.odrive_findings import odrive_findings
from bikesim.bench.odrive_settings import ODriveSettings

from .conftest import Wire
from .lockstep import CIA402, DRIVES, ODRIVE, profile

# Of a machine that others use too: how late a thread is, not what is asked here.
PATIENT = {"drive_age": 0.4, "drive_heartbeats": 20.0, "ramp_age": 0.2, "hold_age": 0.05}
PATIENT["zero_age"] = 0.4


# Seldom enough for devices that share a processor, and an interpreter, with their host.
SELDOM = {
    "cia402": {"heartbeat_timeout": 0.2, "heartbeat_period": 0.05},
    "odrive": {
        "watchdog_timeout": 0.2, "heartbeat_period": 0.05, "estimates_period": 0.01,
        "torques_period": 0.01,
    },
}  # fmt: skip


class Stranger:
    """Sends what is of nobody in the profile."""

    def __init__(self, *ids: int) -> None:
        self._ids = ids

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        return []

    def advance(self, time: float) -> list[Frame]:
        return [Frame(one, bytes(5)) for one in self._ids]


def table(
    wire: Wire,
    drive: dict[str, Any],
    *devices: Device,
    real: Device | None = None,
    bar: dict[str, Any] | None = None,
) -> dict[str, Finding]:
    """By name, lines of one name together; `real`: the drive that is there, default: as told."""
    bench = profile(
        {**drive, **SELDOM[drive["kind"]]},
        bus={"interface": "virtual", "channel": wire.name},
        thresholds=PATIENT,
        bar={"inertia": 0.2311, **(bar or {})},
    ).model_copy(update={"period": 0.01})
    with wire.with_devices(real or emulated_drive(bench.drive), *devices):
        time.sleep(0.02)
        found: dict[str, Finding] = {}
        for one in check.check(bench):
            before = found[one.what].found + "; " if one.what in found else ""
            found[one.what] = one._replace(found=before + one.found)
        return found


@pytest.mark.parametrize("kind", DRIVES)
def test_what_the_drive_says(wire: Wire, kind: str, monkeypatch: pytest.MonkeyPatch):
    """Its watchdog proven before, as no sensor line is red."""
    monkeypatch.setattr(check._Heard, "findings", lambda self: [])
    found = table(wire, DRIVES[kind], EmulatedSteerNode())
    told = {what: (one.good, one.found) for what, one in found.items()}
    if kind == "cia402":
        assert told["drive: network state"] == (True, "operational")
        assert told["drive: state"][1].startswith("switch on disabled (6041 = 0x")
        assert told["drive: mode (6061)"] == (True, "10")
        assert told["drive: error (603F)"] == (True, "none")
        assert told["drive: rated torque"] == (True, "6076 = 386000 uNm = 0.386 N m")
        rates = {"heartbeat 0x705": 20, "status 0x185": 100, "motion 0x285": 100}
    else:
        assert told["drive: state"] == (True, "idle (1)")
        assert told["drive: disarmed last by"][0]
        assert told["drive: disarmed last by"][1].startswith("watchdog timer expired")
        assert told["drive: torque constant"] == (True, "not readable")
        rates = {"heartbeat 0x061": 20, "encoder 0x069": 100, "torques 0x07c": 100}
    for name, rate in rates.items():
        came = found[f"drive: {name}"].found.removesuffix(" a second")
        assert float(came) == pytest.approx(rate, rel=0.4)
    assert told["drive: torque measured"] == (True, "+0.00 N m")
    for one in ("heartbeat", "data owed"):
        assert found[f"drive: {one}, longest pause"].found.endswith(" ms")


@pytest.mark.parametrize("kind", DRIVES)
def test_looked_at_though_the_emergency_stop_is_open_but_not_enabled(wire: Wire, kind: str):
    node = EmulatedSteerNode()
    node.estop_closed = False
    found = table(wire, DRIVES[kind], node)
    assert found["emergency stop"] == Finding(False, "emergency stop", "open", "closed")
    assert found["ids of nobody in the profile"].found == "none"
    assert found["drive: state"].good
    assert "was not tried" in found["drive"].found


@pytest.mark.parametrize("kind", DRIVES)
def test_a_torque_that_it_measures_at_rest(wire: Wire, kind: str):
    node = EmulatedSteerNode()
    node.estop_closed = False  # else the set-up may look first
    real = emulated_drive(profile(DRIVES[kind]).drive)
    assert isinstance(real, EmulatedDrive | EmulatedODrive)
    real.offset = 0.1
    torque = table(wire, DRIVES[kind], node, real=real)["drive: torque measured"]
    gear = DRIVES[kind]["gear"]
    assert not torque.good
    assert float(torque.found.split()[0]) == pytest.approx(0.1 * gear, abs=0.01)


def test_a_drive_of_which_nothing_comes(wire: Wire):
    found = table(wire, CIA402, EmulatedSteerNode(), real=Stranger())
    assert found["drive"].found == "drive 5: does not answer"
    assert found["drive: state"] == Finding(False, "drive: state", "not told", "switch on disabled")
    assert found["drive: heartbeat, longest pause"].found == "never came"
    assert found["drive: heartbeat 0x705"].found == "0 a second"
    assert not any(one.good for what, one in found.items() if what.startswith("drive"))


def test_a_drive_that_cannot_be_set_up_is_only_listened_to(wire: Wire):
    with can.Bus(interface="virtual", channel=wire.name) as tap:
        found = table(
            wire,
            {**CIA402, "torque_unit": "mNm"},
            EmulatedSteerNode(),
            real=emulated_drive(Cia402Settings(**CIA402)),
        )
        sent = {one.arbitration_id for one in iter(lambda: tap.recv(0), None)}
    assert "its unit is uNm, set torque_unit" in found["drive"].found
    assert found["drive: rated torque"].found == "not told"
    assert 0x605 in sent  # its set-up was tried
    assert not sent & {0x080, 0x205, 0x77F}


def test_others_are_named(wire: Wire):
    found = table(wire, CIA402, EmulatedSteerNode(), Stranger(0x321, 0x123))
    name = "ids of nobody in the profile"
    assert found[name] == Finding(True, name, "0x123, 0x321", "none")
    assert found["another host"].good
    assert found["drive: state"].good


@pytest.mark.parametrize("command", [0x205, 0x112], ids=["drive", "sensor node"])
def test_where_another_host_commands_nothing_is_sent(wire: Wire, command: int):
    found = table(wire, CIA402, EmulatedSteerNode(), Stranger(command))
    assert found["another host"].found == f"{command:#05x}"
    assert not found["drive"].good
    assert found["drive"].found == "not asked: see above"
    assert "drive: state" not in found


@pytest.mark.parametrize("kind", DRIVES)
def test_the_bar_as_the_drive_says_it(wire: Wire, kind: str):
    real = emulated_drive(profile(DRIVES[kind]).drive)
    assert isinstance(real, EmulatedDrive | EmulatedODrive)
    real.angle = 0.3 * DRIVES[kind]["gear"]
    bar = {"source": "drive", "drive_zero": 0.1}
    found = table(wire, DRIVES[kind], EmulatedSteerNode(), real=real, bar=bar)
    assert float(found["bar, by the drive's encoder"].found.split()[0]) == pytest.approx(
        0.2, abs=1e-3
    )
    assert found["emergency stop"].found == "not seen by the host"
    assert found["ids of nobody in the profile"].found == "0x110, 0x111"


SAID = Said(NmtState.OPERATIONAL, 0x0250, 10, 0, 0.386)


@pytest.mark.parametrize(
    ("said", "what", "found", "good"),
    [
        (SAID._replace(statusword=0x0218), "state", "fault (6041 = 0x0218)", False),
        (SAID._replace(statusword=0x0237), "state", "operation enabled (6041 = 0x0237)", False),
        (SAID._replace(statusword=0x0218, error=0x8130), "state", "fault (6041 = 0x0218)", True),
        (SAID._replace(error=0x2310), "error (603F)", "0x2310 (over current)", False),
        (SAID._replace(error=0x8130), "error (603F)", "0x8130 (heartbeat of the h", True),
        (SAID._replace(mode=4), "mode (6061)", "4", False),
        (SAID._replace(nmt=NmtState.STOPPED), "network state", "stopped", False),
        (SAID._replace(rated=None), "rated torque", "not told", False),
    ],
)
def test_of_a_cia402_drive(said: Said, what: str, found: str, good: bool):
    """Statuswords of IEC 61800-7-201, error codes of CiA 301 and IEC 61800-7-201."""
    lines = {one.what: one for one in cia402_findings(Cia402Settings(**CIA402), said)}
    line = lines.pop(f"drive: {what}")
    assert (line.found.startswith(found), line.good) == (True, good)
    if said.statusword == SAID.statusword:
        assert all(one.good for one in lines.values())


@pytest.mark.parametrize(
    ("said", "what", "found", "good"),
    [
        (ODriveSaid(1, 0, 0), "state", "idle (1)", True),
        (ODriveSaid(8, 0, 0), "state", "closed-loop control (8)", False),
        (ODriveSaid(None, None, None), "errors", "not told", False),
        (ODriveSaid(1, AxisError.DRV_FAULT, 0), "errors", "drv fault", False),
        (ODriveSaid(1, 0x01000000, 0), "errors", "watchdog timer expired: this host", True),
        (ODriveSaid(1, 0, 0x01000400), "disarmed last by", "dc bus over current, watch", False),
        (ODriveSaid(1, 0, 0), "disarmed last by", "none", True),
    ],
)
def test_of_an_odrive(said: ODriveSaid, what: str, found: str, good: bool):
    lines = {one.what: one for one in odrive_findings(ODriveSettings(**ODRIVE), said)}
    line = lines[f"drive: {what}"]
    assert (line.found.startswith(found), line.good) == (True, good)
