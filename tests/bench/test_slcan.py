"""SLCAN adapters on pseudo-terminals, in a process of their own."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import can
import pytest

from bikesim.bench.bus import BusPort, BusSettings, close_bus, open_bus
from bikesim.bench.emulated.pump import Pump, PumpThread
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.frame import Frame, to_message
from bikesim.bench.slcan import SlcanBus
from bikesim.cli.main import main
from bikesim.record.reader import open_run

from .processes import WATCHDOG, Bench, written

STEER, COMMAND = 0x110, 0x205


class Adapters:
    """Two that share a CAN bus: the host's line, and the bench's."""

    def __init__(self) -> None:
        script = Path(__file__).with_name("slcan_adapters.py")
        self._process = subprocess.Popen(
            [sys.executable, str(script)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._process.stdout is not None
        self.ours, self.theirs = map(_bus, self._process.stdout.readline().split())

    def tell(self, command: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{command}\n")
        self._process.stdin.flush()

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


def _bus(line: str, bitrate: int = 1_000_000) -> BusSettings:
    return BusSettings(
        interface="slcan", channel=line, bitrate=bitrate, arguments={"sleep_after_open": 0}
    )


@pytest.fixture
def adapters() -> Iterator[Adapters]:
    adapters = Adapters()
    yield adapters
    adapters.close()


@contextmanager
def opened(settings: BusSettings) -> Iterator[can.BusABC]:
    bus = open_bus(settings)
    time.sleep(0.05)  # its adapter is told to open, and that takes it a moment
    yield bus
    close_bus(bus)


@contextmanager
def ports(adapters: Adapters) -> Iterator[tuple[BusPort, BusPort]]:
    with opened(adapters.ours) as ours, opened(adapters.theirs) as theirs:
        yield BusPort(ours, {STEER}), BusPort(theirs, {COMMAND})


def settled() -> None:
    time.sleep(0.05)


class TestPort:
    def test_frames_pass_both_ways_and_python_can_reads_what_we_send(self, adapters: Adapters):
        with opened(adapters.ours) as ours, opened(adapters.theirs) as theirs:
            port = BusPort(ours, {STEER, 0x3})
            port.send([Frame(COMMAND, b"\x0f\x00"), Frame(0x7, b""), Frame(0x61, remote=True)])
            came = [theirs.recv(1.0) for _ in range(3)]
            assert [(m.arbitration_id, bytes(m.data), m.is_remote_frame) for m in came if m] == [
                (COMMAND, b"\x0f\x00", False), (0x7, b"", False), (0x61, b"", True)
            ]  # fmt: skip
            for frame in (Frame(STEER, bytes(range(8))), Frame(0x3, remote=True)):
                theirs.send(to_message(frame))
                assert port.receive(1.0) == frame
            assert port.trouble == ""

    def test_answers_to_what_was_sent_do_not_hide_a_frame(self, adapters: Adapters):
        """The adapter answers each frame that it is given; a look that does not wait sees past."""
        with ports(adapters) as (ours, theirs):
            ours.send([Frame(COMMAND, bytes(5))] * 10)
            theirs.send([Frame(STEER, bytes((n,))) for n in range(5)])
            settled()
            assert [ours.receive(0.0) for _ in range(6)] == [
                *(Frame(STEER, bytes((n,))) for n in range(5)), None
            ]  # fmt: skip

    def test_a_wait_is_as_long_as_told(self, adapters: Adapters):
        """python-can's own waits for a millisecond of the serial line."""
        with ports(adapters) as (ours, _):
            waits = []
            for _ in range(50):
                began = time.perf_counter()
                assert ours.receive(0.0003) is None
                waits.append(time.perf_counter() - began)
            assert 0.0003 <= sorted(waits)[25] < 0.0009

    def test_half_a_frame_is_kept_until_the_rest_comes(self, adapters: Adapters):
        with opened(adapters.ours) as ours, opened(adapters.theirs) as theirs:
            port = BusPort(ours, {STEER})
            assert isinstance(theirs, SlcanBus)
            line = theirs.serialPortOrig
            theirs.send(to_message(Frame(STEER, b"\1")))
            line.write(b"t110")
            assert port.receive(0.5) == Frame(STEER, b"\1")
            assert port.receive(0.02) is None
            line.write(b"1AB\r")
            assert port.receive(0.5) == Frame(STEER, b"\xab")

    def test_a_refused_frame_is_trouble(self, adapters: Adapters):
        with opened(adapters.ours) as ours:
            assert isinstance(ours, SlcanBus)
            port = BusPort(ours, {STEER})
            ours.close()  # its channel; the line stays open
            port.send([Frame(COMMAND)])
            assert port.receive(0.5) is None
            assert port.trouble == (
                "cannot receive: the adapter refused a frame: is the bus alive?"
            )

    def test_an_adapter_that_is_unplugged_is_trouble(self, adapters: Adapters):
        with ports(adapters) as (ours, _):
            adapters.tell("unplug")
            settled()
            assert ours.receive(0.05) is None
            assert ours.trouble.startswith("cannot receive: ")
            ours.trouble = ""
            ours.send([Frame(COMMAND)])
            assert ours.trouble.startswith("cannot send: ")
            ours.close()

    def test_an_adapter_that_hangs_holds_nobody_up(self, adapters: Adapters):
        """Its line is full after some kilobytes: python-can's own would wait for ever."""
        with ports(adapters) as (ours, _):
            adapters.tell("hang")
            settled()
            began = time.perf_counter()
            while not ours.trouble and time.perf_counter() - began < 5.0:
                ours.send([Frame(COMMAND, bytes(8))])
            assert ours.trouble == "cannot send: the adapter takes nothing more"
            ours.close()
            assert time.perf_counter() - began < 5.0

    def test_another_bit_rate_hears_nothing(self, adapters: Adapters):
        slow = _bus(adapters.ours.channel, 500_000)
        with opened(slow) as ours, opened(adapters.theirs) as theirs:
            theirs.send(to_message(Frame(STEER)))
            assert BusPort(ours, {STEER}).receive(0.1) is None


def test_a_profile_with_a_wrong_bit_rate(
    adapters: Adapters, tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]
):
    """750 kbit/s, which the loop's frames would fit on, where the bench has 1 Mbit/s."""
    monkeypatch.chdir(tmp_path)
    slow = written("cia402-emulated", tmp_path, _bus(adapters.ours.channel, 750_000))
    with opened(adapters.theirs) as theirs, PumpThread(Pump(theirs, [EmulatedSteerNode()])):
        assert main(["bench", "run", str(slow), "-o", "r.h5"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("bikesim: nobody answers on the bus within 0.25 s: ")
    assert "bus.bitrate" in said
    assert said.count("\n") == 1


def test_it_can_be_closed_twice(adapters: Adapters):
    with opened(adapters.ours) as bus:
        port = BusPort(bus, {STEER})
        port.close()
        port.close()


@pytest.mark.slow
@pytest.mark.real_time
class TestRide:
    """Host, adapters and bench are three processes."""

    def test_a_ride(self, adapters: Adapters, tmp_path: Path):
        bench = Bench(written("cia402-emulated", tmp_path, adapters.ours), bus=adapters.theirs)
        ridden = bench.until_in_time(
            "run", str(bench.path), "--duration", "1.5", "--set", "start.roll_deg=1",
            "-o", "r.h5", "--json",
        )  # fmt: skip
        assert ridden.returncode == 0, ridden.stderr
        run = open_run(tmp_path / "r.h5")
        assert run.ending is not None
        assert run.ending.reason == "end of run"
        assert run.ticks > 500
        assert 0.02 < bench.largest_torque < 3.5
        assert max(run.channel("drive_enabled")) == 1.0
        assert bench.torques[-1][1] == 0.0

    @pytest.mark.parametrize(
        ("command", "row"), [("cut", (1, 14)), ("unplug", (20,))], ids=["cut", "unplug"]
    )
    def test_the_cable_comes_out(
        self, adapters: Adapters, tmp_path: Path, command: str, row: tuple[int, ...]
    ):
        """The host ends with a fault; nobody tells the drive, whose own watchdog disables it."""
        bench = Bench(written("cia402-emulated", tmp_path, adapters.ours), bus=adapters.theirs)
        parted: list[float] = []

        def part(host: subprocess.Popen[str], since: float) -> None:
            if since > 0.8 and not parted:
                adapters.tell(command)
                parted.append(time.monotonic())

        ended = bench.until_in_time(
            "run", str(bench.path), "--duration", "20", "--set", "start.roll_deg=3",
            "-o", "r.h5", do=part,
        )  # fmt: skip
        assert ended.returncode == 2, ended.stderr
        named = tuple(f"bikesim: fault {one}: " for one in row)
        assert ended.stderr.startswith(named), ended.stderr
        assert ended.stderr.count("\n") == 1
        assert "did not say that it is disabled: cut its power" in ended.stdout
        before = [torque for now, torque in bench.torques if parted[0] - 0.2 < now < parted[0]]
        assert max(map(abs, before)) > 0.0
        last = max(now for now, torque in bench.torques if torque != 0.0)
        assert last - parted[0] < WATCHDOG + 0.1
