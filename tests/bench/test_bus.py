import os
import time
from collections.abc import Iterator
from contextlib import contextmanager

import can
import pytest

from bikesim.bench.bus import (
    BusPort,
    BusSettings,
    bus_load,
    close_bus,
    filter_for,
    open_bus,
    worst_bits,
)
from bikesim.bench.drives import make_drive
from bikesim.bench.frame import Frame, to_message
from bikesim.bench.preflight import checked_load
from bikesim.errors import InputError

from .conftest import Wire
from .lockstep import CIA402, ODRIVE, profile


def test_a_frame_of_8_bytes_has_at_most_135_bits():
    """Davis et al. 2007: 8 bytes, 11-bit identifier."""
    assert worst_bits(8) == 135


def test_the_load_of_a_tick_at_1_mbit_is_about_what_the_facts_say():
    """SYNC, RPDO1, two TPDOs and a sensor frame: 535 µs."""
    sizes = (0, 5, 8, 7, 8)
    assert bus_load([(size, 1000.0) for size in sizes], 1_000_000) == pytest.approx(0.55, abs=0.02)


@pytest.mark.parametrize("drive", [CIA402, ODRIVE], ids=["cia402", "odrive"])
def test_1_khz_does_not_fit_on_500_kbit(drive: dict):
    slow = profile(drive, bus={"interface": "virtual", "channel": "x", "bitrate": 500_000})
    with pytest.raises(InputError, match=r"1000 Hz does not fit on 500 kbit/s"):
        checked_load(slow, make_drive(slow.drive))
    fast = profile(drive)
    assert 0.4 < checked_load(fast, make_drive(fast.drive)) < 0.75


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"interface": "sockecan", "channel": "can0"}, "unknown bus.interface 'sockecan'; did you"),
        ({"interface": "socketcan", "channel": "can77"}, "bus socketcan can77: cannot be opened: "),
        ({"interface": "slcan", "channel": "/dev/nobody"}, "bus slcan /dev/nobody: cannot be"),
        ({"interface": "pcan", "channel": "PCAN_USBBUS1"}, "bus pcan PCAN_USBBUS1: cannot be"),
        ({"interface": "udp_multicast", "channel": "10.0.0.1"}, "bus udp_multicast 10.0.0.1: can"),
    ],
    ids=str,
)
def test_no_such_interface(settings: dict, said: str, caplog: pytest.LogCaptureFixture):
    with pytest.raises(InputError) as error:
        open_bus(BusSettings(**settings))
    assert str(error.value).startswith(said)
    assert "\n" not in str(error.value)
    assert not caplog.messages


class TestPort:
    def test_frames_of_others_do_not_hide_those_behind_them(self, wire: Wire):
        with wire.host() as ours, wire.host() as theirs:
            port = BusPort(ours, {0x110})
            for identifier in (0x7FF, 0x080, 0x110, 0x111):
                theirs.send(to_message(Frame(identifier)))
            assert port.receive(0.0) == Frame(0x110)
            assert port.receive(0.0) is None
            assert port.trouble == ""

    def test_both_ways_are_logged(self, wire: Wire):
        log: list[tuple[int, float | None]] = []
        with wire.host() as ours, wire.host() as theirs:
            port = BusPort(ours, {0x110}, lambda one, sent: log.append((one.arbitration_id, sent)))
            theirs.send(to_message(Frame(0x110, b"\1")))
            port.receive(0.1)
            port.send([Frame(0x205, b"\2")])
            assert theirs.recv(0.1) is not None
        assert log[0] == (0x110, None)
        assert log[1] == (0x205, pytest.approx(time.time(), abs=1.0))

    def test_all_of_a_bus_is_logged_error_frames_too(self, wire: Wire):
        """Nobody knows beforehand whose frames explain a fault."""
        log: list[can.Message] = []
        with wire.host() as ours, wire.host() as theirs:
            port = BusPort(ours, {0x110}, lambda one, sent: log.append(one))
            theirs.send(to_message(Frame(0x7FF, b"\1")))
            theirs.send(can.Message(is_error_frame=True, is_extended_id=False))
            theirs.send(can.Message(arbitration_id=0x110, is_extended_id=True))
            theirs.send(to_message(Frame(0x110, b"\2")))
            assert port.receive(0.1) == Frame(0x110, b"\2")
        assert [(one.arbitration_id, one.is_error_frame) for one in log] == [
            (0x7FF, False), (0, True), (0x110, False), (0x110, False)
        ]  # fmt: skip

    def test_what_was_before_is_forgotten(self, wire: Wire):
        with wire.host() as ours, wire.host() as theirs:
            port = BusPort(ours, {0x110})
            for _ in range(50):
                theirs.send(to_message(Frame(0x110)))
            port.flush()
            assert port.receive(0.0) is None

    def test_an_error_frame_is_trouble(self, wire: Wire):
        with wire.host() as ours, wire.host() as theirs:
            port = BusPort(ours, {0x110})
            theirs.send(can.Message(is_error_frame=True, is_extended_id=False))
            assert port.receive(0.05) is None
            assert "wrong bit rate" in port.trouble

    def test_a_bus_that_fails_is_trouble_and_raises_nothing(self, wire: Wire):
        with wire.host() as ours:
            port = BusPort(ours, {0x110})
            ours.shutdown()
            assert port.receive(0.0) is None
            assert port.trouble.startswith("cannot receive")
            port.trouble = ""
            port.send([Frame(0x205)])
            assert port.trouble.startswith("cannot send")

    @pytest.mark.parametrize("timeout", [0.0, 0.01])
    @pytest.mark.parametrize("how", ["shut down", "its socket closed by another"])
    def test_a_socket_that_is_gone_is_trouble_too(self, timeout: float, how: str):
        settings = BusSettings(
            interface="udp_multicast",
            channel="239.74.163.2",
            arguments={"port": 40_000 + os.getpid() % 20_000},
        )
        bus = open_bus(settings)
        port = BusPort(bus, {0x110})
        assert port.receive(timeout) is None
        assert port.trouble == ""
        if how == "shut down":
            bus.shutdown()
        else:
            os.close(bus.fileno())
        assert port.receive(timeout) is None
        assert port.trouble.startswith("cannot receive: ")
        assert not port.send([Frame(0x205)])
        assert port.trouble.startswith("cannot send: ")
        port.close()


class TestEcho:
    """A bus that gives back what one sends; a second master on it all the same is seen."""

    COMMAND = Frame(0x205, bytes(5))

    @contextmanager
    def buses(self) -> Iterator[tuple[can.BusABC, can.BusABC]]:
        settings = BusSettings(
            interface="udp_multicast",
            channel="239.74.163.9",
            arguments={"port": 20_000 + os.getpid() % 20_000},
        )
        ours, theirs = open_bus(settings), open_bus(settings)
        try:
            yield ours, theirs
        finally:
            close_bus(ours)
            close_bus(theirs)

    def test_ones_own_frames_are_passed_over(self):
        with self.buses() as (ours, theirs):
            log: list[int] = []
            port = BusPort(
                ours, {0x110, 0x205}, lambda one, _: log.append(one.arbitration_id), {0x205}
            )
            for _ in range(300):
                port.send([self.COMMAND])
                theirs.send(to_message(Frame(0x110)))
                assert port.receive(0.5) == Frame(0x110)
            assert port.receive(0.0) is None
            assert log == [0x205, 0x110] * 300

    @pytest.mark.parametrize("identifier", [0x205, 0x080])
    def test_one_frame_of_another_is_not(self, identifier: int):
        with self.buses() as (ours, theirs):
            port = BusPort(ours, {0x205, 0x080}, echoed={0x205, 0x080})
            for _ in range(50):
                port.send([self.COMMAND])
                assert port.receive(0.0) is None
            theirs.send(to_message(Frame(identifier, b"\1")))
            assert port.receive(0.5) == Frame(identifier, b"\1")
            assert port.receive(0.0) is None

    def test_what_was_sent_before_it_is_forgotten_does_not_count(self):
        """Of the set-up, on the same bus: it is flushed before the ride."""
        with self.buses() as (ours, theirs):
            for _ in range(10):
                ours.send(to_message(self.COMMAND))
            port = BusPort(ours, {0x205}, echoed={0x205})
            port.flush()
            port.send([self.COMMAND])
            assert port.receive(0.05) is None
            theirs.send(to_message(self.COMMAND))
            assert port.receive(0.5) == self.COMMAND


def test_filters_can_be_taken_away_again(wire: Wire):
    with wire.host() as ours, wire.host() as theirs:
        filter_for(ours, {0x110})
        theirs.send(to_message(Frame(0x111)))
        assert ours.recv(0.05) is None
        filter_for(ours, None)
        theirs.send(to_message(Frame(0x111)))
        assert ours.recv(0.5) is not None


def test_which_buses_echo():
    def echoes(**settings) -> bool:
        return BusSettings(channel="x", **settings).echoes

    assert echoes(interface="udp_multicast")
    assert not echoes(interface="virtual")
    assert echoes(interface="socketcan", arguments={"receive_own_messages": True})
