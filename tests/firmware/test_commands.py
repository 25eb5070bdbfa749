"""The firmware's side of a calibration over CAN."""

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
from bikesim.bench.frame import Frame
from bikesim.errors import InputError

from .binding import Firmware
from .nodes import CALIBRATION, PowerUp, block, state


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
