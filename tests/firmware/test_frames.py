"""The firmware's frames, decoded by cantools with the project's database."""

import zlib

import numpy as np
import pytest
from cantools.database.can import Database

from bikesim.bench.crc import crc8
from bikesim.bench.sensor_node import SteerDecoder, SteerReading, decode_diag

from .binding import Firmware
from .nodes import state


class TestCrc:
    def test_has_the_check_values_of_its_standards(self, node: Firmware):
        assert node.crc8(b"123456789") == 0x4B
        assert node.crc32(b"123456789") == 0xCBF43926

    def test_is_pythons(self, node: Firmware):
        random = np.random.default_rng(2)
        for length in range(40):
            data = random.bytes(length)
            assert node.crc8(data) == crc8(data)
            assert node.crc32(data) == zlib.crc32(data)

    def test_of_a_frame_is_over_the_data_id_and_bytes_1_to_7(self, node: Firmware):
        data = dict(node.cycle())[0x110]
        assert data[0] == crc8(b"\x10" + data[1:])


class TestState:
    def test_angle_and_rate(self, database: Database, node: Firmware):
        """For many raw values: scale times what the raw value is from its zero."""
        random = np.random.default_rng(3)
        for pot, gyro in random.integers(1400, 64000, (300, 2)).tolist():
            node.sample.pot, node.sample.gyro = pot, gyro
            told = state(database, node)
            angle = -5.76 * (pot / 65535 - round(0.45 * 65536) / 65536)
            rate = 10.47 * (gyro - round(0.51 * 65536)) / 65536
            # The wiper's ratio has 1/65536, 88 urad; a count of the angle 50 urad.
            expected = float(np.clip(angle, -1.63835, 1.63835))
            assert told["SteerAngle"] == pytest.approx(expected, abs=115e-6)
            assert told["SteerRate"] == pytest.approx(rate, abs=0.26e-3)

    def test_the_potentiometer_is_ratiometric(self, database: Database, node: Firmware):
        """Its supply falls by 3 %, wiper and reference with it: the same angle."""
        node.sample.pot, node.sample.reference = 20000, 65535
        before = state(database, node)["SteerAngle"]
        node.sample.pot, node.sample.reference = 19400, 63569
        assert state(database, node)["SteerAngle"] == pytest.approx(before, abs=2e-4)

    def test_what_does_not_fit_is_saturated(self, database: Database, node: Firmware):
        node.sample.pot, node.sample.gyro = 65000, 65000
        assert state(database, node)["SteerAngle"] == pytest.approx(-1.63835)

    @pytest.mark.parametrize("part", ["pot", "gyro"])
    @pytest.mark.parametrize(
        ("raw", "good"),
        [(0, 0), (1310, 0), (1312, 1), (32768, 1), (64220, 1), (64226, 0), (65535, 0)],
    )
    def test_an_open_or_shorted_wire(
        self, database: Database, node: Firmware, part: str, raw: int, good: int
    ):
        """2 % and 98 % of 65536 are 1310.7 and 64225.3."""
        setattr(node.sample, part, raw)
        told = state(database, node)
        assert told["PotOk" if part == "pot" else "GyroOk"] == good
        assert told["GyroOk" if part == "pot" else "PotOk"] == 1

    @pytest.mark.parametrize(
        ("supply_mv", "good"), [(3300, 1), (3140, 1), (3130, 0), (3460, 1), (3470, 0), (0, 0)]
    )
    def test_the_reference(self, database: Database, node: Firmware, supply_mv: int, good: int):
        node.sample.supply_mv = supply_mv
        assert state(database, node)["VrefOk"] == good

    def test_no_reference_is_no_crash(self, database: Database, node: Firmware):
        node.sample.reference = 0
        told = state(database, node)
        assert (told["VrefOk"], told["PotOk"]) == (0, 0)

    @pytest.mark.parametrize("closed", [True, False])
    def test_the_emergency_stop(self, database: Database, node: Firmware, closed: bool):
        node.sample.estop_closed = closed
        assert state(database, node)["EstopClosed"] == closed

    def test_counter_and_time_wrap_around(self, database: Database, node: Firmware):
        told = [state(database, node) for _ in range(1400)]
        assert [one["Counter"] for one in told] == [n % 15 for n in range(1400)]
        ticks = [round(one["SampleTime"] / 1e-5) for one in told]
        assert ticks == [100 * (n + 1) % 65536 for n in range(1400)]

    def test_the_hosts_decoder_finds_no_flaw(self, node: Firmware):
        decoder = SteerDecoder()
        for n in range(1400):
            reading = decoder.decode(dict(node.cycle())[0x110], n * 1e-3)
            assert isinstance(reading, SteerReading)
            assert reading.lost == 0
            assert reading.time == pytest.approx((n + 1) * 1e-3)


class TestDiag:
    def test_every_twentieth_cycle_after_the_state(self, node: Firmware):
        sent = [[identifier for identifier, _ in node.cycle()] for _ in range(60)]
        assert [n for n, ids in enumerate(sent) if 0x111 in ids] == [0, 20, 40]
        assert sent[20] == [0x110, 0x111]

    def test_what_it_tells(self, node: Firmware):
        node.sample.pot, node.sample.gyro, node.sample.temperature = 16384, 49152, -12
        told = decode_diag(dict(node.cycle())[0x111])
        assert told == pytest.approx((0.25, 0.75, 3.3, -12, 1), abs=1.1e-3)


def test_each_cycle_waits_once_and_feeds_the_watchdog_once(node: Firmware):
    for _ in range(10):
        node.cycle()
    assert (node.board.waits, node.board.feeds) == (10, 10)
