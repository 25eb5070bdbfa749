import itertools

import pytest

from bikesim.bench.crc import FrameCrc, crc8


def test_the_check_value_of_sae_j1850():
    assert crc8(b"123456789") == 0x4B


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ("00000000", 0x59), ("F20183", 0x37), ("0FAA0055", 0x79), ("00FF5511", 0xB8),
        ("332255AABBCCDDEEFF", 0xCB), ("926B55", 0x8C), ("FFFFFFFF", 0x74),
    ],
)  # fmt: skip
def test_the_examples_that_autosar_gives(data: str, expected: int):
    """AUTOSAR's specification of CRC routines, table of CRC8 (SAE J1850)."""
    assert crc8(bytes.fromhex(data)) == expected


def test_of_a_frame_is_over_data_id_and_bytes_1_to_7():
    data = bytes(range(8))
    assert FrameCrc(0x10)(data) == crc8(bytes((0x10, 1, 2, 3, 4, 5, 6, 7)))


def test_finds_each_error_of_one_or_two_bits():
    crc = FrameCrc(0x10)
    sealed = int.from_bytes(crc.seal(bytes.fromhex("00f3d00730f850c3")), "little")
    for first, second in itertools.combinations_with_replacement(range(64), 2):
        damaged = (sealed ^ (1 << first | 1 << second)).to_bytes(8, "little")
        assert crc(damaged) != damaged[0]


def test_another_messages_frame_does_not_pass():
    sealed = FrameCrc(0x10).seal(bytes(8))
    assert FrameCrc(0x20)(sealed) != sealed[0]
