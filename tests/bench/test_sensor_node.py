"""Decoding against cantools on the same database, and what is bad."""

import math
from pathlib import Path

import cantools
import numpy as np
import pytest
from cantools.database.can import Message

from bikesim.bench.continuity import BadFrame, Flaw
from bikesim.bench.crc import crc8
from bikesim.bench.sensor_node import (
    SteerDecoder,
    SteerDiag,
    SteerEncoder,
    SteerReading,
    SteerStatus,
    decode_diag,
    encode_diag,
)


@pytest.fixture(scope="module")
def state(repository: Path) -> Message:
    database = cantools.database.load_file(repository / "hardware" / "can" / "steer_node.dbc")
    assert isinstance(database, cantools.database.Database)
    return database.get_message_by_name("SteerState")


def sealed(data: bytes) -> bytes:
    return bytes((crc8(b"\x10" + data[1:]),)) + data[1:]


def test_the_database_has_the_layout_of_the_specification(state: Message):
    layout = {s.name: (s.start, s.length, s.is_signed, s.scale) for s in state.signals}
    assert state.frame_id == 0x110
    assert layout == {
        "Crc": (0, 8, False, 1), "Counter": (8, 4, False, 1),
        "PotOk": (12, 1, False, 1), "GyroOk": (13, 1, False, 1),
        "VrefOk": (14, 1, False, 1), "EstopClosed": (15, 1, False, 1),
        "SteerAngle": (16, 16, True, 50e-6), "SteerRate": (32, 16, True, 0.5e-3),
        "SampleTime": (48, 16, False, 10e-6),
    }  # fmt: skip


def test_each_frame_decodes_as_cantools_decodes_it(state: Message):
    random = np.random.default_rng(5)
    for _ in range(500):
        data = sealed(b"\0" + random.bytes(7))
        reading = SteerDecoder().decode(data, 0.0)
        known = state.decode_simple(data)
        assert isinstance(reading, SteerReading)
        assert reading.steer == known["SteerAngle"]
        assert reading.steer_rate == known["SteerRate"]
        assert reading.time == pytest.approx(known["SampleTime"], abs=1e-12)
        bits = (reading.pot_ok, reading.gyro_ok, reading.vref_ok, reading.estop_closed)
        assert bits == tuple(known[k] for k in ("PotOk", "GyroOk", "VrefOk", "EstopClosed"))


def test_each_frame_encodes_as_cantools_encodes_it(state: Message):
    encoder = SteerEncoder()
    for n in range(40):
        steer, rate = 0.8 * math.sin(n), -5 * math.cos(n)
        status = SteerStatus(n % 2 == 0, n % 3 == 0, n % 5 == 0, n % 7 == 0)
        frame = encoder.encode(n * 1e-3, steer, rate, status)
        signals = {
            "Crc": frame.data[0], "Counter": n % 15, "SampleTime": n * 1e-3,
            "PotOk": status.pot_ok, "GyroOk": status.gyro_ok, "VrefOk": status.vref_ok,
            "EstopClosed": status.estop_closed, "SteerAngle": steer, "SteerRate": rate,
        }  # fmt: skip
        assert frame.id == state.frame_id
        assert frame.data == state.encode(signals) == sealed(frame.data)


def test_right_is_positive():
    reading = SteerDecoder().decode(SteerEncoder().encode(0.0, 0.1, 0.5).data, 0.0)
    assert isinstance(reading, SteerReading)
    assert (reading.steer, reading.steer_rate) == pytest.approx((0.1, 0.5))


def test_what_does_not_fit_is_saturated():
    reading = SteerDecoder().decode(SteerEncoder().encode(0.0, 9.0, -99.0).data, 0.0)
    assert isinstance(reading, SteerReading)
    assert (reading.steer, reading.steer_rate) == pytest.approx((1.63835, -16.3835))


@pytest.mark.parametrize("bit", range(64))
def test_a_frame_with_a_wrong_bit_is_bad(bit: int):
    data = bytearray(SteerEncoder().encode(0.5, 0.1, 0.2).data)
    data[bit // 8] ^= 1 << bit % 8
    assert SteerDecoder().decode(bytes(data), 0.0) == BadFrame(Flaw.CRC)


@pytest.mark.parametrize("data", [b"", b"\0" * 7, b"\0" * 9], ids=len)
def test_a_frame_of_another_length_is_bad(data: bytes):
    assert SteerDecoder().decode(data, 0.0) == BadFrame(Flaw.LENGTH)


def test_a_bad_frame_does_not_hide_that_one_is_missing():
    decoder, encoder = SteerDecoder(), SteerEncoder()
    frames = [encoder.encode(n * 1e-3, 0.0, 0.0).data for n in range(3)]
    decoder.decode(frames[0], 0.0)
    damaged = decoder.decode(b"\xff" + frames[1][1:], 1e-3)
    assert damaged == BadFrame(Flaw.CRC)
    reading = decoder.decode(frames[2], 2e-3)
    assert isinstance(reading, SteerReading)
    assert reading.lost == 1


def test_a_frame_again_is_bad():
    decoder = SteerDecoder()
    data = SteerEncoder().encode(0.0, 0.0, 0.0).data
    decoder.decode(data, 0.0)
    assert decoder.decode(data, 1e-3) == BadFrame(Flaw.REPEATED)


def test_diagnosis_there_and_back():
    diag = SteerDiag(0.25, 0.75, 3.28, -7, 12)
    frame = encode_diag(diag)
    assert (frame.id, len(frame.data)) == (0x111, 8)
    assert decode_diag(frame.data) == pytest.approx(diag)
