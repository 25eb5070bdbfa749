"""The host's side against the emulated node; the firmware's own is in tests/firmware."""

import pytest

from bikesim.bench.calibration import CalibrationClient, NodeCalibration
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.frame import Frame
from bikesim.bench.sensor_node import SteerDecoder, SteerReading
from bikesim.errors import InputError

SENSORS = NodeCalibration(0.47, -5.9, 0.52, 10.0, 3.3)
OTHER = NodeCalibration(0.5, 5.0, 0.5, 10.0, 3.3)


def reading(node: EmulatedSteerNode) -> SteerReading:
    (frame, *_) = EmulatedSteerNode.advance(node, 10.0)
    decoded = SteerDecoder().decode(frame.data, 10.0)
    assert isinstance(decoded, SteerReading)
    return decoded


def test_what_is_stored_acts_and_is_read_back():
    node = EmulatedSteerNode(sensors=SENSORS, stored=OTHER)
    node.steer, node.steer_rate, node.estop_closed = 0.2, -1.0, False
    client = CalibrationClient(SimulatedLink([node]))
    assert client.read() == pytest.approx(OTHER, abs=1e-5)
    client.change(SENSORS)
    assert client.read() == pytest.approx(SENSORS, abs=1e-5)
    assert reading(node).steer == pytest.approx(0.2, abs=2e-4)


def test_not_while_the_drive_may_have_power():
    node = EmulatedSteerNode(stored=OTHER)
    with pytest.raises(InputError, match="press the emergency stop first"):
        CalibrationClient(SimulatedLink([node])).change(SENSORS)
    assert node.stored == OTHER


def test_a_node_that_is_not_there():
    with pytest.raises(InputError, match="does not answer"):
        CalibrationClient(SimulatedLink([])).read()


class Lossy(EmulatedSteerNode):
    """Hears only every second command."""

    heard = 0

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        self.heard += 1
        return super().receive(frame, time) if self.heard % 2 else []


def test_a_command_that_got_lost_is_sent_again():
    node = Lossy(sensors=SENSORS, stored=OTHER)
    node.estop_closed = False
    CalibrationClient(SimulatedLink([node])).change(SENSORS)
    assert node.stored == pytest.approx(SENSORS, abs=1e-5)
    assert node.heard > 11


def test_a_damaged_command_changes_nothing():
    node = EmulatedSteerNode(stored=OTHER)
    node.estop_closed = False
    assert node.receive(Frame(0x112, bytes.fromhex("0031000000000000")), 0.0) == []


def test_a_value_that_does_not_fit():
    node = EmulatedSteerNode(stored=OTHER)
    node.estop_closed = False
    with pytest.raises(InputError, match="angle scale = 3000000000 does not fit"):
        CalibrationClient(SimulatedLink([node])).change(SENSORS._replace(angle_scale=3000.0))


@pytest.mark.parametrize(("pot", "good"), [(0.0, False), (0.019, False), (0.5, True), (1.0, False)])
def test_an_open_or_shorted_potentiometer_is_told(pot: float, good: bool):
    node = EmulatedSteerNode()
    node.pot = pot
    assert reading(node).pot_ok is good


def test_a_node_that_was_never_calibrated_says_so():
    bits = reading(EmulatedSteerNode(stored=None))
    assert (bits.pot_ok, bits.gyro_ok, bits.vref_ok) == (False, False, True)
