"""The calibration that a profile says its node has: at the start of a ride, and kept in a file."""

import tomllib
from pathlib import Path

import pytest

from bikesim.bench.calibration import Command, NodeCalibration, decode_command, encode_reply
from bikesim.bench.calibration_check import calibration_finding, check_calibration, differences
from bikesim.bench.calibration_kept import keep_calibration, kept_calibration
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION, EmulatedSteerNode
from bikesim.bench.frame import Frame
from bikesim.bench.profile import bench_path, load_bench
from bikesim.bench.profile_file import changed_text
from bikesim.errors import InputError

from .lockstep import profile

USUAL = [32768, 5760000, 32768, 10470000, 3300]
MIRRORED = USUAL_CALIBRATION._replace(angle_scale=-5.76)


class Deaf(EmulatedSteerNode):
    """Sends its samples, and answers nothing."""

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        return []


class AnswersTwoHosts(EmulatedSteerNode):
    """Another host asks at the same time, with the same number, for the reference voltage."""

    def receive(self, frame: Frame, time: float) -> list[Frame]:
        own = super().receive(frame, time)
        asked = decode_command(frame.data)
        assert asked is not None
        return [encode_reply(asked._replace(parameter=4, result=0, value=3300)), *own]


def checked(node: EmulatedSteerNode, wanted: list[int] = USUAL) -> None:
    check_calibration(SimulatedLink([node]), wanted)


@pytest.mark.parametrize("estop_closed", [True, False])
def test_the_one_of_the_profile_is_let_pass(estop_closed: bool):
    node = EmulatedSteerNode()
    node.estop_closed = estop_closed
    checked(node)


def test_one_of_another_sign_is_refused_and_told():
    with pytest.raises(InputError) as refused:
        checked(EmulatedSteerNode(stored=MIRRORED))
    said = str(refused.value)
    assert said.startswith(
        "fault 22: the sensor node's calibration is not this profile's: angle scale -5.76 rad "
        "(profile 5.76); "
    )
    assert "bar.calibration = [32768, -5760000, 32768, 10470000, 3300]" in said
    assert "gyro" not in said
    assert "\n" not in said


@pytest.mark.parametrize("figure", range(5))
def test_each_figure_counts_to_the_last_digit(figure: int):
    other = [count + (i == figure) for i, count in enumerate(USUAL)]
    said = differences(NodeCalibration.of_counts(tuple(other)), USUAL)
    assert said.count("(profile ") == 1
    is_, should = said.removesuffix(")").split(" (profile ")
    assert should not in is_.split()


def test_a_node_that_does_not_answer_is_one_line():
    with pytest.raises(InputError) as refused:
        checked(Deaf())
    assert str(refused.value) == (
        "fault 22: bar.calibration cannot be checked: sensor node: does not answer a calibration "
        "command (0x112)"
    )


@pytest.mark.parametrize(
    ("node", "wanted", "good", "found"),
    [
        (EmulatedSteerNode(), USUAL, True, str(USUAL)),
        (EmulatedSteerNode(), None, True, str(USUAL)),
        (EmulatedSteerNode(stored=MIRRORED), USUAL, False, "angle scale -5.76 rad (profile 5.76)"),
        (Deaf(), USUAL, False, "sensor node: does not answer a calibration command (0x112)"),
    ],
    ids=["the same", "none wanted", "mirrored", "deaf"],
)
def test_in_the_table_of_check(
    node: EmulatedSteerNode, wanted: list[int] | None, good: bool, found: str
):
    line = calibration_finding(SimulatedLink([node]), wanted)
    assert (line.good, line.found) == (good, found)


def test_an_answer_to_another_host_is_passed_over():
    """Without it each figure would be the first that anybody asked for."""
    assert Command.READ == 1
    checked(AnswersTwoHosts())


def test_the_profile_has_what_the_emulated_node_has():
    for name in ("cia402-emulated", "odrive-emulated"):
        assert load_bench(name).bar.calibration == USUAL_CALIBRATION.counts()


def test_the_pulse_is_of_a_calibration():
    def mark(**bar: object) -> str:
        return profile(bar={"inertia": 0.2311, **bar}).commissioning

    assert mark(calibration=USUAL) == mark(calibration=USUAL)
    mirrored = [*USUAL[:1], -USUAL[1], *USUAL[2:]]
    assert len({mark(), mark(calibration=USUAL), mark(calibration=mirrored)}) == 3


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (USUAL[:4], "must be a list of 5"),
        ([*USUAL, 1], "must be a list of 5"),
        ([0.5, *USUAL[1:]], "must be a whole number"),
        ([2**31, *USUAL[1:]], "must be at"),
        ("usual", "must be a list"),
    ],
)
def test_a_profile_with_another_kind_of_entry(given: object, told: str):
    with pytest.raises(InputError, match="calibration") as refused:
        profile(bar={"inertia": 0.2311, "calibration": given})
    assert told in str(refused.value)


@pytest.mark.parametrize("line", ["", "calibration = [1, 2, 3, 4, 5]  # old\n"])
def test_it_is_written_into_a_profile(line: str):
    text = bench_path("cia402-emulated").read_text()
    before = text.replace("calibration = [32768, 5760000, 32768, 10470000, 3300]\n", line)
    assert before != text
    changed = tomllib.loads(changed_text(before, {"bar.calibration": USUAL}))
    assert changed == tomllib.loads(text)


class TestKept:
    def test_it_is_read_again_to_the_count(self, tmp_path: Path):
        has = NodeCalibration.of_counts((30811, -5234567, 33333, 9600001, 3312))
        kept = keep_calibration(tmp_path / "mine.toml", has)
        assert kept.name.startswith("mine.node.")
        assert kept_calibration(kept).counts() == has.counts()

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            (None, "no such file"),
            ("pot_zero = 0.5\n", "angle_scale: must be given"),
            ("nothing", "not TOML"),
            ("angle_scale = 0.01", "angle_scale = 0.01: must be 0.1 or more, of either sign"),
            ("rate_scale = 4000.0", "rate_scale = 4000.0: must be at least -2000 and at most 2000"),
            ("pot_zero = 1.0", "pot_zero = 1.0: must be at least 0 and below 1"),
            ('gyro_zero = "0.5"', "gyro_zero = '0.5': must be a number"),
            ("[bar]\ninertia = 0.2", "'bar'"),
        ],
    )
    def test_a_file_that_is_none_is_one_line(self, tmp_path: Path, text: str | None, told: str):
        path = tmp_path / "node.bak"
        if text is not None:
            given = text.partition(" ")[0]
            rest = {
                key: value for key, value in USUAL_CALIBRATION._asdict().items() if key != given
            }
            usual = "".join(f"{key} = {value}\n" for key, value in rest.items())
            alone = told in ("angle_scale: must be given", "not TOML")
            path.write_text(text if alone else usual + text)
        with pytest.raises(InputError) as refused:
            kept_calibration(path)
        assert told in str(refused.value)
        assert str(path) in str(refused.value)
        assert "\n" not in str(refused.value)
