from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database

from bikesim.bench.continuity import BadFrame, Flaw
from bikesim.bench.emulated.wheel_node import EmulatedWheelNode
from bikesim.bench.wheel_node import WheelDecoder, WheelEncoder, WheelReading, WheelSettings
from bikesim.errors import InputError

WHEEL = WheelSettings(radius=0.34)


def test_decodes_as_cantools_does(repository: Path):
    database = cantools.database.load_file(repository / "hardware" / "can" / "steer_node.dbc")
    assert isinstance(database, Database)
    frame = WheelEncoder(WHEEL).encode(0.25, 5.0, 70000)
    known = database.get_message_by_name("WheelSpeed").decode_simple(frame.data)
    reading = WheelDecoder(WHEEL).decode(frame.data, 0.0)
    assert isinstance(reading, WheelReading)
    assert reading.speed == pytest.approx(0.34 * float(known["WheelRate"]))  # type: ignore
    assert reading.speed == pytest.approx(5.0, abs=0.34 * 0.005)
    assert reading.pulses == known["Pulses"] == 70000 - 65536
    assert (reading.sensor_ok, reading.lost, reading.time) == (True, 0, known["SampleTime"])


def test_a_sensor_that_is_mounted_the_other_way_round():
    backwards = WheelSettings(radius=0.34, direction=-1)
    reading = WheelDecoder(WHEEL).decode(WheelEncoder(backwards).encode(0.0, 3.0, 0).data, 0.0)
    assert isinstance(reading, WheelReading)
    assert reading.speed == pytest.approx(-3.0, abs=0.002)


def test_a_damaged_frame_is_bad():
    data = WheelEncoder(WHEEL).encode(0.0, 3.0, 0).data
    assert WheelDecoder(WHEEL).decode(data[:-1] + b"\x55", 0.0) == BadFrame(Flaw.CRC)


def test_the_emulated_node_sends_the_speed_every_10_ms():
    node, decoder = EmulatedWheelNode(WHEEL), WheelDecoder(WHEEL)
    node.speed = 4.0
    frames = [(n, f) for n in range(1001) for f in node.advance(n * 1e-3)]
    assert len(frames) == 101
    readings = [decoder.decode(frame.data, n * 1e-3) for n, frame in frames]
    good = [one for one in readings if isinstance(one, WheelReading)]
    assert len(good) == 101
    assert {one.lost for one in good} == {0}
    assert good[-1].speed == pytest.approx(4.0, abs=0.002)
    assert good[-1].pulses == pytest.approx(4.0 / (2 * 3.14159265 * 0.34) * 32, abs=1)


@pytest.mark.parametrize("given", [{"radius": 0.0}, {"radius": 0.3, "direction": 2}, {}], ids=str)
def test_what_cannot_be_is_refused_in_one_line(given: dict):
    with pytest.raises(InputError) as error:
        WheelSettings(**given)
    assert "wheel." in str(error.value)
    assert "\n" not in str(error.value)
