"""The firmware's frames, decoded by cantools with the project's database."""

import shutil
import struct
import subprocess
import zlib
from collections.abc import Callable
from pathlib import Path

import cantools
import numpy as np
import pytest
from cantools.database.can import Database

from bikesim.bench.calibration import (
    CalibrationClient,
    Command,
    Exchange,
    NodeCalibration,
    Parameter,
    Result,
    decode_reply,
    encode_command,
)
from bikesim.bench.crc import crc8
from bikesim.bench.frame import Frame
from bikesim.bench.sensor_node import SteerDecoder, SteerReading, decode_diag
from bikesim.errors import InputError

from .binding import Firmware

PowerUp = Callable[..., Firmware]
CALIBRATION = NodeCalibration(0.45, -5.76, 0.51, 10.47, 3.3)


def block(calibration: NodeCalibration = CALIBRATION, version: int = 1) -> bytes:
    """What the memory of a calibrated node has, as calibration.h says."""
    data = struct.pack("<4sHH5i", b"BCAL", version, 20, *calibration.counts())
    return data + struct.pack("<I", zlib.crc32(data))


@pytest.fixture(scope="module")
def database(repository: Path) -> Database:
    found = cantools.database.load_file(repository / "hardware" / "can" / "steer_node.dbc")
    assert isinstance(found, Database)
    return found


@pytest.fixture
def node(power_up: PowerUp) -> Firmware:
    return power_up(block())


def state(database: Database, node: Firmware) -> dict:
    frames = dict(node.cycle())
    return dict(database.get_message_by_name("SteerState").decode_simple(frames[0x110]))


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


class FirmwareLink:
    """The firmware as the host's calibration sees it."""

    def __init__(self, node: Firmware) -> None:
        self._node, self._time = node, 0.0
        self._inbox: list[Frame] = []

    def now(self) -> float:
        return self._time

    def send(self, frame: Frame) -> None:
        self._inbox += [Frame(0x113, data) for data in self._node.command(*frame[:2])]

    def receive(self, timeout: float) -> Frame | None:
        self._time += timeout
        return self._inbox.pop(0) if self._inbox else None


OTHER = NodeCalibration(0.52, 5.0, 0.49, -8.0, 3.25)


class TestCommands:
    def test_a_calibration_there_and_back_and_kept_without_power(
        self, power_up: PowerUp, node: Firmware
    ):
        node.sample.estop_closed = False
        node.cycle()
        client = CalibrationClient(FirmwareLink(node))
        assert client.read().counts() == CALIBRATION.counts()
        client.change(OTHER)
        assert node.memory == block(OTHER)
        again = power_up(node.memory)
        assert CalibrationClient(FirmwareLink(again)).read().counts() == OTHER.counts()

    def test_only_what_is_stored_acts(self, database: Database, node: Firmware):
        node.sample.estop_closed = False
        before = state(database, node)["SteerAngle"]
        write = Exchange(1, Command.WRITE, Parameter.POT_ZERO, value=20000)
        assert self.ask(node, write).result == Result.DONE
        assert state(database, node)["SteerAngle"] == before
        assert self.ask(node, Exchange(2, Command.STORE)).result == Result.DONE
        assert state(database, node)["SteerAngle"] != before

    def test_what_is_forgotten_is_not_stored(self, node: Firmware):
        node.sample.estop_closed = False
        node.cycle()
        self.ask(node, Exchange(1, Command.WRITE, Parameter.POT_ZERO, value=20000))
        self.ask(node, Exchange(2, Command.FORGET))
        self.ask(node, Exchange(3, Command.STORE))
        assert node.memory == block()

    @pytest.mark.parametrize("command", [Command.WRITE, Command.STORE, Command.FORGET])
    def test_nothing_changes_while_the_drive_may_have_power(self, node: Firmware, command: Command):
        told = self.ask(node, Exchange(1, command, Parameter.POT_ZERO, value=20000))
        assert told.result == Result.NOT_IDLE
        assert node.memory == block()

    def test_not_before_the_first_sample_either(self, power_up: PowerUp):
        node = power_up(block())
        node.sample.estop_closed = True
        with pytest.raises(InputError, match="press the emergency stop first"):
            CalibrationClient(FirmwareLink(node)).change(OTHER)

    @pytest.mark.parametrize(
        ("parameter", "value", "result"),
        [
            (Parameter.POT_ZERO, -1, Result.OUT_OF_RANGE),
            (Parameter.POT_ZERO, 65536, Result.OUT_OF_RANGE),
            (Parameter.ANGLE_SCALE, 0, Result.OUT_OF_RANGE),
            (Parameter.RATE_SCALE, -(2**31), Result.OUT_OF_RANGE),
            (Parameter.REFERENCE_VOLTAGE, -3300, Result.OUT_OF_RANGE),
            (5, 0, Result.NO_SUCH_PARAMETER),
            (255, 0, Result.NO_SUCH_PARAMETER),
        ],
    )
    def test_what_cannot_be_is_refused(
        self, node: Firmware, parameter: int, value: int, result: Result
    ):
        node.sample.estop_closed = False
        node.cycle()
        assert self.ask(node, Exchange(1, Command.WRITE, parameter, 0, value)).result == result

    @pytest.mark.parametrize("command", [0, 5, 15])
    def test_an_unknown_command_is_refused(self, node: Firmware, command: int):
        assert self.ask(node, Exchange(1, command)).result == Result.NO_SUCH_COMMAND

    def test_an_answer_tells_which_command_it_is_to(self, node: Firmware):
        told = self.ask(node, Exchange(11, Command.READ, Parameter.ANGLE_SCALE))
        assert told == (11, Command.READ, Parameter.ANGLE_SCALE, Result.DONE, -5760000)

    @pytest.mark.parametrize("bit", range(0, 64, 3))
    def test_a_damaged_command_is_not_answered(self, node: Firmware, bit: int):
        data = bytearray(encode_command(Exchange(1, Command.READ)).data)
        data[bit // 8] ^= 1 << bit % 8
        assert node.command(0x112, bytes(data)) == []

    def test_a_short_command_is_not_answered(self, node: Firmware):
        assert node.command(0x112, encode_command(Exchange(1, Command.READ)).data[:7]) == []

    def test_a_memory_that_fails_is_told_and_nothing_acts(self, database: Database, node: Firmware):
        node.sample.estop_closed = False
        node.board.memory_fails = True
        before = state(database, node)["SteerAngle"]
        self.ask(node, Exchange(1, Command.WRITE, Parameter.POT_ZERO, value=20000))
        assert self.ask(node, Exchange(2, Command.STORE)).result == Result.MEMORY_FAILED
        assert state(database, node)["SteerAngle"] == before

    @staticmethod
    def ask(node: Firmware, command: Exchange) -> Exchange:
        (answer,) = node.command(0x112, encode_command(command).data)
        told = decode_reply(answer)
        assert told is not None
        return told


def test_each_cycle_waits_once_and_feeds_the_watchdog_once(node: Firmware):
    for _ in range(10):
        node.cycle()
    assert (node.board.waits, node.board.feeds) == (10, 10)


# Syntax, where no cross compiler is at hand: sizes of registers and the assembler are the board's.
BOARD = ("board_stm32f3.c", "memory_stm32f3.c", "start_stm32f3.c", "main.c")


@pytest.mark.parametrize("file", BOARD)
def test_the_boards_part_has_no_mistake_that_this_compiler_sees(repository: Path, file: str):
    compiler = shutil.which("arm-none-eabi-gcc")
    flags = ["-mcpu=cortex-m4", "-mthumb"] if compiler else ["-Wno-int-to-pointer-cast"]
    checked = subprocess.run(
        [compiler or "cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic",
         "-ffreestanding", "-fsyntax-only", *flags, file],
        cwd=repository / "hardware" / "firmware", capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert checked.returncode == 0, checked.stderr
