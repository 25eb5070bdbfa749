"""What the firmware takes for a calibration in its memory."""

import pytest
from cantools.database.can import Database

from .nodes import CALIBRATION, PowerUp, block, state


class TestMemory:
    def test_a_whole_block_is_a_calibration(self, database: Database, power_up: PowerUp):
        told = state(database, power_up(block()))
        assert (told["PotOk"], told["GyroOk"]) == (1, 1)

    @pytest.mark.parametrize("byte", range(32))
    def test_a_block_with_a_wrong_byte_is_none(
        self, database: Database, power_up: PowerUp, byte: int
    ):
        damaged = bytearray(block())
        damaged[byte] ^= 0x04
        told = state(database, power_up(bytes(damaged)))
        assert (told["PotOk"], told["GyroOk"]) == (0, 0)

    @pytest.mark.parametrize(
        "memory",
        [
            b"\xff" * 32,
            bytes(32),
            block(version=2),
            block(CALIBRATION._replace(angle_scale=0.0)),
            block(CALIBRATION._replace(pot_zero=-0.1)),
            block(CALIBRATION._replace(reference_voltage=9.0)),
        ],
        ids=["erased", "zero", "version 2", "no scale", "negative zero", "9 V"],
    )
    def test_a_block_that_is_none(self, database: Database, power_up: PowerUp, memory: bytes):
        told = state(database, power_up(memory))
        assert (told["PotOk"], told["GyroOk"]) == (0, 0)
