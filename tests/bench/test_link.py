"""Frames on real backends of python-can."""

import time

import can
import pytest

from bikesim.bench.cia402_frames import CobIds
from bikesim.bench.emulated.pump import Pump, PumpThread
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.frame import Frame, from_message, to_message
from bikesim.bench.link import BusLink, can_filters, until
from bikesim.bench.odrive import ids_from_odrive, ids_to_odrive
from bikesim.bench.sensor_node import SteerDecoder, SteerReading

from .conftest import Wire


@pytest.mark.parametrize(
    "frame", [Frame(0x77F, b"\x05"), Frame(0x080), Frame(0x069, remote=True)], ids=repr
)
def test_a_frame_goes_over_a_bus_as_it_is(wire: Wire, frame: Frame):
    with wire.host() as ours, wire.host() as theirs:
        BusLink(ours).send(frame)
        assert BusLink(theirs).receive(1.0) == frame


@pytest.mark.parametrize(
    "message",
    [
        can.Message(arbitration_id=0x110, is_extended_id=True),
        can.Message(is_error_frame=True, is_extended_id=False),
        can.Message(arbitration_id=0x110, is_extended_id=False, is_fd=True),
    ],
    ids=str,
)
def test_frames_of_another_format_are_not_ours(message: can.Message):
    assert from_message(message) is None


def test_nothing_comes(wire: Wire):
    with wire.host() as bus:
        assert BusLink(bus).receive(0.01) is None
        assert list(until(BusLink(bus), time.monotonic() + 0.01)) == []


def test_a_sensor_node_on_a_bus(wire: Wire):
    node, decoder = EmulatedSteerNode(), SteerDecoder()
    node.steer = 0.3
    with wire.with_devices(node) as bus:
        readings = [
            decoder.decode(frame.data, time.monotonic())
            for frame in until(BusLink(bus), time.monotonic() + 0.2)
            if frame.id == 0x110
        ]
    good = [one for one in readings if isinstance(one, SteerReading)]
    assert len(good) == len(readings) > 20
    assert good[-1].steer == pytest.approx(0.3, abs=1e-4)


class TestMulticast:
    """udp_multicast gives back what one sent; the filters keep each side's own frames away."""

    ids = CobIds.of_node(5)

    def test_with_the_filters_only_the_others_frames_come(self):
        with (
            self.bus(self.ids.from_drive) as host,
            self.bus(self.ids.to_drive(127)) as device,
        ):
            command, status = Frame(self.ids.command, b"\x0f\0"), Frame(self.ids.status, b"\x37")
            host.send(to_message(command))
            device.send(to_message(status))
            assert BusLink(device).receive(1.0) == command
            assert BusLink(host).receive(1.0) == status
            assert BusLink(host).receive(0.05) is None
            assert BusLink(device).receive(0.05) is None

    def test_without_them_ones_own_do(self):
        with self.bus(range(0x800)) as host:
            host.send(to_message(Frame(self.ids.command)))
            assert BusLink(host).receive(1.0) == Frame(self.ids.command)

    @staticmethod
    def bus(ids) -> can.BusABC:
        return can.Bus(
            interface="udp_multicast",
            channel="239.74.163.5",
            port=43175,
            can_filters=can_filters(ids),
        )


def test_no_filter_of_an_odrives_host_lets_its_own_frames_through():
    passed = {one["can_id"] for one in can_filters(ids_from_odrive(3))}
    assert not passed & set(ids_to_odrive(3))


class Failing:
    """A device with a mistake in it."""

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        raise ZeroDivisionError

    def advance(self, time: float) -> list[Frame]:
        raise ZeroDivisionError


def test_a_mistake_in_a_device_is_not_lost_with_its_thread(wire: Wire):
    with wire.host() as bus, pytest.raises(ZeroDivisionError), PumpThread(Pump(bus, [Failing()])):
        time.sleep(0.05)
